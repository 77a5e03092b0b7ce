// Print for a silicone mold, made again from the part: the same as the STL files beside this one.
// Which print: "board" (master on its parting board), "box-upper", "box-lower".
half = "board"; // [board, box-upper, box-lower]

/* [Part] */
part = "@part@";
// Corners of the part's bounding box, mm.
part_low = @part_low@;
part_high = @part_high@;
// Height of the parting plane, mm.
parting = @parting@;

/* [Wall] */
// Silicone above and below the part, mm.
silicone = @silicone@;
// Silicone beside the part, room for keys, mm.
rim = @rim@;
// Of box and board, mm.
wall = @wall@;
// Least side of the silicone block, mm.
least_side = @least_side@;
// Left under a key, mm.
edge = @edge@;
// Around the box walls, mm.
lip = @lip@;

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

/* [Hidden] */
$fn = @sides@;
beyond = 1;
grid = @grid@;
wider = [for (k = [0, 1]) max(0, (least_side - (part_high[k] - part_low[k] + 2 * rim)) / 2)];
room = key_height + key_clearance + edge;
low = [part_low[0] - rim - wider[0], part_low[1] - rim - wider[1], min(part_low[2] - silicone, parting - room)];
high = [part_high[0] + rim + wider[0], part_high[1] + rim + wider[1], max(part_high[2] + silicone, parting + room)];
middle = (low + high) / 2;
keys = [[low[0] + rim / 2, middle[1]], [high[0] - rim / 2, middle[1]], [middle[0], low[1] + rim / 2]];
// Half the board, on the grid of the files: a part on it stays on it when it is moved.
lift = round(max(room, wall) / 2 / grid) * grid;

module box(a, b) { translate(a) cube(b - a); }

// A box around the silicone, `out` wider on all sides.
module around(out, from, to) box([low[0] - out, low[1] - out, from], [high[0] + out, high[1] + out, to]);

module key(air) rotate_extrude()
    polygon([[0, 0], [key_diameter / 2 + air, 0], [key_diameter / 2 * key_tip + air, key_height + air], [0, key_height + air]]);

module channel(c) {
    height = high[2] - c[0][2];
    translate(c[0]) cylinder(h = height + beyond, d1 = c[1], d2 = c[2] + (c[2] - c[1]) / height * beyond);
}

module upper_master() {
    intersection() { import(part, convexity = 20); around(0, parting, high[2]); }
    for (k = keys) translate([k[0], k[1], parting]) key(key_clearance);
    intersection() {
        union() { for (c = sprues) channel(c); for (c = vents) channel(c); }
        around(0, parting, high[2] + beyond);
    }
}

module lower_master() intersection() { import(part, convexity = 20); around(0, low[2], parting); }

module board() {
    near = wall + key_clearance;
    difference() {
        union() {
            around(near + lip, parting - lift, parting + lift);
            translate([0, 0, lift]) upper_master();
            translate([0, 0, -lift]) lower_master();
        }
        for (k = keys) translate([k[0], k[1], parting - lift]) key(0);
        for (k = keys) translate([k[0], k[1], parting - lift - beyond]) cylinder(h = beyond, d = key_diameter);
    }
    difference() {
        around(near + lip, parting - lift - lip, parting + lift + lip);
        around(near, parting - lift - lip - beyond, parting + lift + lip + beyond);
    }
}

module box_wall(from, to) difference() {
    around(wall, from, to);
    around(0, from - beyond, to + beyond);
}

if (half == "board") board();
if (half == "box-upper") translate([0, 0, lift]) box_wall(parting, high[2]);
if (half == "box-lower") translate([0, 0, -lift]) box_wall(low[2], parting);
