// Mold of two halves and side cores, made again from the part: the same as the STL files beside this one.
// The cores leave first, each along its pull, in the order of their names.
// Which piece, or "all" with the cores drawn out.
half = "all"; // [all, lower, upper, @names@]

/* [Part] */
part = "@part@";
// What lies below the parting surface; empty where that is a plane.
below = "@below@";
// Height of the parting plane, mm.
parting = @parting@;

/* [Cores] */
core_names = @core_names@;
// Each core with a room that goes into the part: less the part it is the core. Empty where no such room is a solid: there
// the core is taken as it is.
core_rooms = @core_rooms@;
core_files = @core_files@;
core_pulls = @core_pulls@;
// How far "all" draws them out, mm.
out = 60;

/* [Wall] */
// Corners of the block, mm.
low = @low@;
high = @high@;

/* [Keys] */
// Feet of the keys.
keys = @keys@;
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
bolts = @bolts@;
slots = @slots@;

/* [Hidden] */
$fn = @sides@;
beyond = 1;
// Moves what was made to meet the part in a line, mm, so that rounding does not make it touch in points.
aside = @aside@;
// How many times that copies of one core stand apart: the steps between them stay larger than those beside what is only aside.
copies_apart = 4;
// How much less a core's place is moved where it is made itself: of a small one the skin would count.
finer = 8;

module box(a, b) { translate(a) cube(b - a); }

module key(air) rotate_extrude()
    polygon([[0, -beyond], [key_diameter / 2 + air, -beyond], [key_diameter / 2 + air, 0],
        [key_diameter / 2 * key_tip + air, key_height + air], [0, key_height + air]]);

module keys(air) for (k = keys) translate(k) key(air);

module channel(c) {
    height = high[2] - c[0][2];
    translate(c[0]) cylinder(h = height + beyond, d1 = c[1], d2 = c[2] + (c[2] - c[1]) / height * beyond);
}

module bolts() for (b = bolts)
    translate([b[0], b[1], low[2] - beyond]) cylinder(h = high[2] - low[2] + 2 * beyond, d = bolt);

module below() if (below == "") box(low, [high[0], high[1], parting]); else translate(aside) import(below, convexity = 20);

module place(k) import(core_rooms[k] == "" ? core_files[k] : core_rooms[k], convexity = 20);

// A core as it is meets the part in its own walls, and a later one the earlier ones; taken on all sides of its place it
// leaves no skin there.
module cores() for (k = [0:len(core_rooms) - 1])
    if (k > 0 || core_rooms[k] == "") for (s = [[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]])
        translate(copies_apart * [for (i = [0:2]) s[i] * aside[i]]) place(k);
    else translate(aside) place(k);

module lower() difference() {
    union() {
        difference() { below(); import(part, convexity = 20); }
        keys(0);
    }
    bolts();
    cores();
}

module upper() difference() {
    box(low, high);
    below();
    import(part, convexity = 20);
    keys(key_clearance);
    bolts();
    for (s = slots) box(s[0], s[1]);
    for (c = sprues) channel(c);
    for (c = vents) channel(c);
    cores();
}

module core(k) if (core_rooms[k] == "") place(k);
else difference() { translate(aside / finer) place(k); import(part, convexity = 20); }

if (half == "lower" || half == "all") lower();
if (half == "upper") upper();
if (half == "all") translate([high[0] - low[0] + 10, 0, 0]) upper();
for (k = [0:len(core_rooms) - 1]) {
    if (half == core_names[k]) core(k);
    if (half == "all") translate(core_pulls[k] * out) core(k);
}
