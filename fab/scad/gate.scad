// Takes a part's file, or pairs of files; gives the part, or what the two of each pair share, beside a cube of 1 mm3
// that stands `at` a far corner. The cube is there so that sharing nothing is an answer with a volume of its own, not an
// empty object, which versions of OpenSCAD report in different ways; and the union sends a part through the exact kernel.
part = "";
pairs = [];
at = [0, 0, 0];
union() {
    if (part != "") import(part, convexity = 20);
    for (pair = pairs) intersection() {
        import(pair[0], convexity = 20);
        import(pair[1], convexity = 20);
    }
    translate(at) cube(1);
}
