// Two-part mold, made again from the part: the same as the STL files beside this one.
// Which half: "lower", "upper", or "both" side by side.
half = "both"; // [both, lower, upper]

/* [Part] */
part = "@part@";
// Corners of the part's bounding box, mm.
part_low = @part_low@;
part_high = @part_high@;
// What lies below the parting surface; empty where that is a plane.
below = "@below@";
// Height of the parting plane, mm.
parting = @parting@;

/* [Wall] */
// Least wall above and below the part, mm.
wall = @wall@;
// Around the part, for keys and screws, mm.
rim = @rim@;
// Least side of the block, mm.
least_side = @least_side@;
// Left beside keys and screws, mm.
edge = @edge@;

/* [Keys] */
key_diameter = @key_diameter@;
key_height = @key_height@;
key_clearance = @key_clearance@;
key_tip = @key_tip@; // share of the diameter

/* [Sprue] */
// Each: foot, then diameters at the part and at the outside.
sprues = @sprues@;

/* [Vents] */
vents = @vents@;

/* [Screws and slots] */
bolt = @bolt@;
slot = @slot@;

/* [Hidden] */
$fn = @sides@;
beyond = 1;
// Moves what was made to meet the part in a line, mm, so that rounding does not make it touch in points.
aside = @aside@;
wider = [for (k = [0, 1]) max(0, (least_side - (part_high[k] - part_low[k] + 2 * rim)) / 2)];
room = key_height + key_clearance + edge;
low = [part_low[0] - rim - wider[0], part_low[1] - rim - wider[1], min(part_low[2] - wall, parting - room)];
high = [part_high[0] + rim + wider[0], part_high[1] + rim + wider[1], max(part_high[2] + wall, parting + room)];
middle = (low + high) / 2;
keys = [[low[0] + rim / 2, middle[1]], [high[0] - rim / 2, middle[1]], [middle[0], low[1] + rim / 2]];
screw = bolt / 2 + edge;

module box(a, b) { translate(a) cube(b - a); }

module key(air) rotate_extrude()
    polygon([[0, -beyond], [key_diameter / 2 + air, -beyond], [key_diameter / 2 + air, 0],
        [key_diameter / 2 * key_tip + air, key_height + air], [0, key_height + air]]);

module keys(air) for (k = keys) translate([k[0], k[1], parting]) key(air);

module channel(c) {
    height = high[2] - c[0][2];
    translate(c[0]) cylinder(h = height + beyond, d1 = c[1], d2 = c[2] + (c[2] - c[1]) / height * beyond);
}

module bolts() for (x = [low[0] + screw, high[0] - screw], y = [low[1] + screw, high[1] - screw])
    translate([x, y, low[2] - beyond]) cylinder(h = high[2] - low[2] + 2 * beyond, d = bolt);

module slots() {
    translate([middle[0] - slot[0] / 2, high[1] - slot[1], parting]) cube([slot[0], slot[1] + beyond, slot[2]]);
    translate([middle[0] - key_diameter / 2 - edge - slot[0], low[1] - beyond, parting]) cube([slot[0], slot[1] + beyond, slot[2]]);
}

module below() if (below == "") box(low, [high[0], high[1], parting]); else translate(aside) import(below, convexity = 20);

module lower() difference() {
    union() {
        difference() { below(); import(part, convexity = 20); }
        keys(0);
    }
    bolts();
}

module upper() difference() {
    box(low, high);
    below();
    import(part, convexity = 20);
    keys(key_clearance);
    bolts();
    slots();
    for (c = sprues) channel(c);
    for (c = vents) channel(c);
}

if (half != "upper") lower();
if (half == "upper") upper();
if (half == "both") translate([high[0] - low[0] + 10, 0, 0]) upper();
