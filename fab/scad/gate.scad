// Takes a part's file, or pairs of files, each with the factor that takes it to finished size about the datum; gives the
// part, or what the two of each pair share, beside a cube of 1 mm3 that stands `at` a far corner. The cube is there so that sharing nothing is an answer with a volume of its own, not an
// empty object, which versions of OpenSCAD report in different ways; and the union sends a part through the exact kernel.
part = "";
pairs = [];
at = [0, 0, 0];
datum = [0, 0, 0];
module finished(file, factor) {
    if (factor == 1) import(file, convexity = 20);
    else translate(datum) scale(factor) translate(-datum) import(file, convexity = 20);
}
union() {
    if (part != "") import(part, convexity = 20);
    for (pair = pairs) intersection() {
        finished(pair[0], pair[2]);
        finished(pair[1], pair[3]);
    }
    translate(at) cube(1);
}
