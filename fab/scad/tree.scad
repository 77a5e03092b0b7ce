// Flask for lost wax and the tree's runner, made again: the same as the STL files beside this one.
// Which: "tree" (patterns on runner and gates), "flask".
half = "tree"; // [tree, flask]

/* [Part] */
// The pattern, its gate along -x at the origin.
part = "@part@";

/* [Sprue] */
runner = @runner@;
// Height of the runner below its cup, mm.
top = @top@;
gate = @gate@;
// From the runner's middle to the pattern, and on into it, mm.
reach = @reach@;
into = @into@;
// Each level: height, patterns around the runner.
levels = @levels@;

/* [Wall] */
flask_radius = @flask_radius@;
flask_wall = @flask_thick@;
flask_low = @flask_low@;
flask_high = @flask_high@;

/* [Hidden] */
$fn = @sides@;

module pattern() {
    translate([reach, 0, 0]) import(part, convexity = 20);
    rotate([0, 90, 0]) cylinder(h = reach + into, d = gate);
}

module tree() {
    cylinder(h = top, d = runner);
    translate([0, 0, top]) cylinder(h = runner, d1 = runner, d2 = 2 * runner);
    for (l = levels, k = [0:l[1] - 1]) translate([0, 0, l[0]]) rotate(360 * k / l[1]) pattern();
}

module flask() translate([0, 0, flask_low]) difference() {
    cylinder(h = flask_high - flask_low, r = flask_radius + flask_wall);
    translate([0, 0, -1]) cylinder(h = flask_high - flask_low + 2, r = flask_radius);
}

if (half == "tree") tree();
if (half == "flask") flask();
