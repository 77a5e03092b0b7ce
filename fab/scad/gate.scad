// Takes a part's file (and a neighbour's); gives the part, or what both share, beside a cube of 1 mm3 that stands `at` a
// far corner. The cube is there so that sharing nothing is an answer with a volume of its own, not an empty object,
// which versions of OpenSCAD report in different ways; and the union sends a single part through the exact kernel too.
a = "";
b = "";
at = [0, 0, 0];
union() {
    if (b == "") import(a, convexity = 20);
    else intersection() {
        import(a, convexity = 20);
        import(b, convexity = 20);
    }
    translate(at) cube(1);
}
