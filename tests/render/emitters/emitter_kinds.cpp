#include "emitter_kinds.h"

#include "support/scene_text.h"

namespace pbrt::test {

namespace {

const std::string kOneSided = "AreaLightSource 'diffuse' 'spectrum L' [ 300 1 900 1 ]\n";
const std::string kTwoSided = "AreaLightSource 'diffuse' 'spectrum L' [ 300 1 900 1 ] 'bool twosided' true\n";
const std::string kPanel = std::string(PBRT_SOURCE_DIR) + "/tests/conformance/suite/scenes/assets/panel.png";
const std::string kImage =
    "AreaLightSource 'diffuse' 'string filename' '" + kPanel + "' 'float scale' 1.5 'bool twosided' true\n";
/// Alpha textures: holes, and two greys.
const std::string kHoles =
    "Texture 'holes' 'float' 'checkerboard' 'float uscale' 6 'float vscale' 4 'float tex1' 1 'float tex2' 0\n";
const std::string kGreys =
    "Texture 'greys' 'float' 'checkerboard' 'float uscale' 4 'float vscale' 4 'float tex1' 0.8 'float tex2' 0.2\n";
/// Parameters of shapes with them.
const std::string kWithHoles = "'texture alpha' 'holes'", kWithGreys = "'texture alpha' 'greys'";

const std::string kReverse = "ReverseOrientation\n";
/// Opens bowls and troughs to the camera and the floor.
const std::string kTowardsCamera = "Rotate -50 1 0 0\n", kDownwards = "Rotate 75 1 0.2 0\n";

std::string Shape(const std::string &type, const std::string &parameters) {
    return "Shape '" + type + "' " + parameters + "\n";
}
std::string Sphere(const std::string &parameters) { return Shape("sphere", parameters); }
std::string Disk(const std::string &parameters) { return Shape("disk", "'float radius' 0.65 " + parameters); }
std::string Cylinder(const std::string &parameters) {
    return Shape("cylinder", "'float radius' 0.45 'float zmin' -0.6 'float zmax' 0.5 " + parameters);
}
/// Half a sphere.
const std::string kBowl = "'float radius' 0.6 'float zmin' -0.6 'float zmax' 0.05 ";
const std::string kTwoTriangles =
    "'point3 P' [ -0.6 -0.6 0.1  0.6 -0.5 0  0.6 0.6 -0.1  -0.5 0.6 0.2 ] 'integer indices' [ 0 1 2 0 2 3 ] "
    "'point2 uv' [ 0 0 1 0 1 1 0 1 ] ";
/// Of the second triangle some vertex normals lie on the other side.
const std::string kBentNormals = "'normal N' [ 0 0 1  0.1 0 1  0 0.1 1  0.2 0 -1 ] ";
const std::string kBall =
    "'integer levels' 2 'point3 P' [ 1 0 0  -1 0 0  0 1 0  0 -1 0  0 0 1  0 0 -1 ] "
    "'integer indices' [ 0 2 4  2 1 4  1 3 4  3 0 4  2 0 5  1 2 5  3 1 5  0 3 5 ] ";
const std::string kRectangle = "'point3 P' [ -0.6 -0.5 0  0.6 -0.5 0  -0.6 0.5 0  0.6 0.5 0 ] ";
const std::string kTrapezoid = "'point3 P' [ -0.6 -0.5 0  0.6 -0.5 0  -0.2 0.5 0  0.3 0.6 0 ] ";
const std::string kSaddle = "'point3 P' [ -0.5 -0.5 0.4  0.5 -0.5 -0.4  -0.5 0.5 -0.4  0.5 0.5 0.4 ] ";

/// Two triangles.
std::string Triangles(const std::string &parameters = "") { return Shape("trianglemesh", kTwoTriangles + parameters); }
std::string Patch(const std::string &parameters) { return Shape("bilinearmesh", parameters); }

}  // namespace

std::vector<EmitterKind> EmitterKinds() {
    std::vector<EmitterKind> kinds;
    auto add = [&](const std::string &name, const std::string &text) { kinds.push_back({name, text}); };
    auto addWithin = [&](const std::string &name, const std::string &text) {
        kinds.push_back({name, text, Place::Within});
    };
    auto addMesh = [&](const std::string &name, const std::string &text) {
        kinds.push_back({name, text, Place::Around, true});
    };
    const std::string whole = "'float radius' 0.6 ", sampled = "'string emissionfilename' '" + kPanel + "'";
    add("sphere", kOneSided + Sphere(whole));
    add("sphere, scaled", kOneSided + "Scale 2 2 2\n" + Sphere("'float radius' 0.3"));
    add("sphere, mirrored and reversed", kOneSided + "Scale -1 1 1\n" + kReverse + Sphere(whole));
    add("sphere, two-sided, image", kImage + Sphere(whole));
    add("sphere, two-sided, alpha 0.5", kTwoSided + Sphere(whole + "'float alpha' 0.5"));
    add("sphere, two-sided, grey texture", kGreys + kTwoSided + Sphere(whole + kWithGreys));
    add("sphere, reversed, holes", kHoles + kReverse + kOneSided + Sphere(whole + kWithHoles));
    add("ellipsoid", kOneSided + "Scale 1 0.4 0.8\n" + Sphere(whole));
    add("ellipsoid, mirrored and reversed", kOneSided + "Scale 1 -0.5 0.8\n" + kReverse + Sphere(whole));
    add("ellipsoid, two-sided, alpha 0.3", kTwoSided + "Scale 1 0.6 1\n" + Sphere(whole + "'float alpha' 0.3"));
    add("bowl", kOneSided + kTowardsCamera + Sphere(kBowl));
    add("bowl, reversed", kReverse + kOneSided + kTowardsCamera + Sphere(kBowl));
    add("bowl, two-sided", kTwoSided + kDownwards + Sphere(kBowl));
    add("bowl, mirrored, scaled", kOneSided + kTowardsCamera + "Scale -1.5 1.5 1.5\n" +
                                      Sphere("'float radius' 0.4 'float zmin' -0.4 'float zmax' 0"));
    add("bowl, two-sided, stretched", kTwoSided + kTowardsCamera + "Scale 1 0.6 1.1\n" + Sphere(kBowl));
    add("bowl, two-sided, alpha 0.4", kTwoSided + kTowardsCamera + Sphere(kBowl + "'float alpha' 0.4"));
    add("bowl, two-sided, image", kImage + kTowardsCamera + Sphere(kBowl));
    add("bowl, reversed, holes", kHoles + kReverse + kOneSided + kTowardsCamera + Sphere(kBowl + kWithHoles));
    add("cap, two-sided", kTwoSided + kDownwards + Sphere("'float radius' 0.7 'float zmin' 0.5 'float zmax' 0.7"));
    add("band in part, two-sided",
        kTwoSided + kDownwards + Sphere(whole + "'float zmin' -0.3 'float zmax' 0.4 'float phimax' 220"));
    add("slice, two-sided", kTwoSided + "Rotate 70 0 0 1\n" + Sphere(whole + "'float phimax' 150"));

    add("disk", kOneSided + kDownwards + Disk(""));
    add("disk, mirrored", kOneSided + kDownwards + "Scale 1 1 -1\n" + Disk(""));
    add("ring, two-sided", kTwoSided + kDownwards + Disk("'float innerradius' 0.4"));
    add("fan, mirrored", kReverse + kOneSided + kDownwards + "Scale -1 1 1\n" + Disk("'float phimax' 230"));
    add("ring in part, stretched",
        kOneSided + kDownwards + "Scale 1 0.5 1\n" + Disk("'float innerradius' 0.2 'float phimax' 290"));
    add("disk, alpha 0.5", kOneSided + kDownwards + Disk("'float alpha' 0.5"));
    add("disk, alpha 0 and 1", kHoles + kTwoSided + kDownwards + Disk(kWithHoles));
    add("ring, image", kImage + kDownwards + Disk("'float innerradius' 0.2"));

    add("cylinder", kOneSided + "Rotate 60 1 1 0\n" + Cylinder(""));
    add("cylinder, two-sided, stretched", kTwoSided + "Rotate 60 1 1 0\nScale 1 0.5 1\n" + Cylinder(""));
    add("trough, reversed",
        kReverse + kOneSided + "Rotate 80 1 0 0\nRotate 200 0 0 1\n" + Cylinder("'float phimax' 170"));
    add("trough, mirrored", kOneSided + "Rotate 80 1 0 0\nScale -1 1 1\n" + Cylinder("'float phimax' 200"));
    add("trough, two-sided, grey texture",
        kGreys + kTwoSided + "Rotate 80 1 0 0\n" + Cylinder("'float phimax' 200 " + kWithGreys));
    add("trough, image", kImage + "Rotate 80 1 0 0\nRotate 200 0 0 1\n" + Cylinder("'float phimax' 200"));

    addMesh("triangles", kOneSided + kDownwards + Triangles());
    addMesh("triangles, mirrored and reversed", kOneSided + kDownwards + "Scale 1 1 -1.2\n" + kReverse + Triangles());
    addMesh("triangles, normals on both sides", kOneSided + kDownwards + Triangles(kBentNormals));
    addMesh("triangles, two-sided, alpha 0.5", kTwoSided + kDownwards + Triangles("'float alpha' 0.5"));
    addMesh("triangles, two-sided, holes", kHoles + kTwoSided + kDownwards + Triangles(kWithHoles));
    addMesh("triangles, image", kImage + kDownwards + Triangles());
    // The normals of "loopsubdiv" point inwards here.
    addMesh("ball of triangles, reversed", kReverse + kOneSided + "Scale 0.9 0.9 0.9\n" + Shape("loopsubdiv", kBall));
    addMesh("ball of triangles, two-sided, alpha 0.6",
            kTwoSided + "Scale -0.9 0.7 0.9\n" + Shape("loopsubdiv", kBall + "'float alpha' 0.6"));

    add("rectangle", kOneSided + kDownwards + Patch(kRectangle));
    add("rectangle, mirrored, two-sided", kTwoSided + kDownwards + "Scale -1 1 1\n" + Patch(kRectangle));
    add("rectangle, grey texture", kGreys + kOneSided + kDownwards + Patch(kRectangle + kWithGreys));
    add("rectangle, image", kImage + kDownwards + Patch(kRectangle));
    add("rectangle, image sampled", kImage + kDownwards + Patch(kRectangle + sampled));
    add("rectangle, another image sampled", kTwoSided + kDownwards + Patch(kRectangle + sampled));
    add("trapezoid, reversed", kReverse + kOneSided + "Rotate 180 0 1 0\n" + kDownwards + Patch(kTrapezoid));
    add("saddle, two-sided", kTwoSided + kDownwards + Patch(kSaddle));
    add("saddle, mirrored", kOneSided + kDownwards + "Scale 1 1 -1\n" + Patch(kSaddle));
    add("saddle, two-sided, alpha 0.5", kTwoSided + kDownwards + Patch(kSaddle + "'float alpha' 0.5"));

    addWithin("sphere, reversed, within", kReverse + kOneSided + Sphere(""));
    addWithin("sphere, mirrored, within", kOneSided + "Scale -1 1 1\n" + Sphere(""));
    addWithin("sphere, two-sided, grey, within", kGreys + kTwoSided + Sphere(kWithGreys));
    addWithin("ellipsoid, two-sided, within", kTwoSided + "Scale 1.2 0.9 1\n" + Sphere(""));
    addWithin("bowl, two-sided, within", kTwoSided + kDownwards + Sphere("'float zmax' 0.4"));
    addWithin("cylinder, reversed, within", kReverse + kOneSided + Shape("cylinder", "'float radius' 0.9"));
    addWithin("trough, stretched, within",
              kTwoSided + "Scale 1 1.2 1\n" + Shape("cylinder", "'float radius' 0.9 'float phimax' 300"));

    for (const auto &[name, shape] :
         {std::pair<std::string, std::string>{"sphere, alpha 0", Sphere(whole + "'float alpha' 0")},
          {"bowl, alpha 0", kDownwards + Sphere(kBowl + "'float alpha' 0")}}) {
        add(name, kOneSided + shape);
        kinds.back().isSeen = false;
    }
    return kinds;
}

std::string EmitterScene(const EmitterKind &kind) {
    const bool within = kind.place == Place::Within;
    Objects world;
    world.Material("diffuse", "'spectrum reflectance' [ 300 0.5 900 0.5 ]");
    world.Attribute("AreaLightSource 'diffuse' 'spectrum L' [ 300 1 900 1 ] 'bool twosided' true 'float scale' 0.3",
                    Objects().Quad(within ? "-0.2 0.5 -0.2  0.2 0.5 -0.2  -0.2 0.5 0.2  0.2 0.5 0.2"
                                          : "0.7 0.8 0.1  1.1 0.8 0.1  0.7 0.8 0.5  1.1 0.8 0.5"));
    if (within) {
        world.Quad("-0.45 -0.35 0.4  0.45 -0.35 0.4  -0.45 0.4 0.2  0.45 0.4 0.2");
        world.Quad("-0.45 -0.35 -0.4  0.45 -0.35 -0.4  -0.45 -0.35 0.4  0.45 -0.35 0.4");
    } else {
        world.Quad("-1.2 -1 -1.4  1.2 -1 -1.4  -1.2 -1 1.2  1.2 -1 1.2");
        world.Quad("-1.2 -1 1.2  1.2 -1 1.2  -1.2 1.2 1.2  1.2 1.2 1.2");
        world.Quad("-1.2 -1 -1.4  -1.2 -1 1.2  -1.2 1.2 -1.4  -1.2 1.2 1.2");
        const bool isHollow =
            kind.text.find("'sphere'") != std::string::npos || kind.text.find("'cylinder'") != std::string::npos;
        if (isHollow) world.Quad("-.12 -.06 -.12  .12 -.06 -.12  -.12 .08 .12  .12 .08 .12");
    }
    world.Attribute("", Objects().Add(kind.text));
    return SceneText()
        .LookAt(within ? "0 0.15 -0.6  0 0 0.2  0 1 0" : "0 0.7 -3.4  0 -0.1 0  0 1 0")
        .Camera(within ? 70 : 42)
        .Film(32, 32)
        .Filter("box")
        .Integrator("path", 1)
        .World(world);
}

}  // namespace pbrt::test
