// What light samples and connections lead to does not hide itself: from points that see a convex surface no segment to
// it is blocked, at any scale, far from the origin, from near and far, and at grazing angles.
#include <gtest/gtest.h>

#include "pbrt/math/rng.h"
#include "pbrt/math/warps.h"
#include "pbrt/scene/scene.h"
#include "placed_scene.h"
#include "support/build_text.h"

namespace pbrt::test {
namespace {

struct ConvexShape {
    const char *name;
    const char *text;  ///< about 1 large, around the origin
};
constexpr ConvexShape kShapes[] = {
    {"sphere", "Shape 'sphere' 'float radius' 1"},
    {"ellipsoid", "Scale 1 .2 .5 Shape 'sphere' 'float radius' 1"},
    {"cylinder", "Shape 'cylinder' 'float radius' .3"},
    {"disk", "Shape 'disk' 'float radius' .7"},
    {"triangles",
     "Shape 'trianglemesh' 'point3 P' [ -1 -1 0  1 -1 0  1 1 0  -1 1 0 ] 'integer indices' [ 0 1 2 0 2 3 ]"},
    {"parallelogram", "Shape 'bilinearmesh' 'point3 P' [ -1 -.5 0  1 -.5 0  -1 .5 0  1 .5 0 ]"},
    {"trapezoid", "Shape 'bilinearmesh' 'point3 P' [ -1 -.5 0  1 -.5 0  -.5 .5 0  .25 .5 0 ]"},
    {"octahedron",
     "Shape 'trianglemesh' 'point3 P' [ 1 0 0  -1 0 0  0 1 0  0 -1 0  0 0 1  0 0 -1 ] 'integer indices' "
     "[ 0 2 4  2 1 4  1 3 4  3 0 4  2 0 5  1 2 5  3 1 5  0 3 5 ]"},
};

struct Blocked {
    int segments = 0, blocked = 0;
};

/// Draws a point that sees `target` from a distance of 0.01 to 1e4 times `size`, at an angle to its surface of a
/// thousandth and more.
Point3 PointThatSees(const Point3 &target, const Normal3 &n, Float size, Rng &rng) {
    const Float distance = size * std::pow(Float(10), Lerp(rng.Uniform(), Float(-2), Float(4)));
    const Float cosine = std::pow(Float(10), -3 * rng.Uniform());
    Vector3 s, t;
    CoordinateSystem(n, &s, &t);
    const Float phi = 2 * Pi * rng.Uniform(), sine = SafeSqrt(1 - cosine * cosine);
    return target + distance * (n * cosine + s * (sine * std::cos(phi)) + t * (sine * std::sin(phi)));
}

/// Leaves out points whose height above the target's plane is lost where their coordinates are rounded.
void Count(const Scene &scene, const LightSampleContext &from, const LightLiSample &to, Blocked *count) {
    const Float height = AbsDot(from.p - to.pLight, to.nLight);
    if (!(height > Float(1e-6) * MaxComponent(Max(Abs(from.p), Abs(to.pLight))))) return;
    ++count->segments;
    count->blocked += scene.Occluded(from, to);
}

/// The normal on the outside of a convex shape. Flat shapes have two outsides, of which `n` is one.
Normal3 Outwards(const Normal3 &n, const Vector3 &fromCenter, Float size) {
    return Dot(n, fromCenter) < Float(-1e-2) * size ? -n : n;
}

/// Points found by rays from all around, as vertices of paths are.
Blocked ConnectToHits(const Scene &scene, Rng &rng) {
    const Bounds3 bounds = scene.Bounds();
    const Point3 center = (bounds.low + bounds.high) / Float(2);
    const Float size = Length(bounds.Diagonal()) / 2;
    Blocked count;
    for (int i = 0; i < 4000; ++i) {
        const Point3 o = center + 2 * size * SampleUniformSphere(rng.Uniform2());
        const Point3 target = center + Float(0.3) * size * SampleUniformSphere(rng.Uniform2());
        const std::optional<SurfacePoint> hit = scene.Intersect({.o = o, .d = Normalize(target - o)});
        if (!hit) continue;
        LightLiSample to;
        to.pLight = hit->p;
        to.pLightError = hit->pError;
        to.nLight = hit->n;
        LightSampleContext from;
        from.p = PointThatSees(hit->p, Outwards(FaceForward(hit->n, hit->wo), hit->p - center, size), size, rng);
        to.wi = Normalize(to.pLight - from.p);
        Count(scene, from, to, &count);
    }
    return count;
}

/// Light samples of an area light.
Blocked ConnectToSamples(const Scene &scene, Rng &rng) {
    const Bounds3 bounds = scene.Bounds();
    const Point3 center = (bounds.low + bounds.high) / Float(2);
    const Float size = Length(bounds.Diagonal()) / 2;
    Blocked count;
    for (int i = 0; i < 4000; ++i) {
        const LightComponent light = scene.Lights()[LightId(uint32_t(rng.Uniform() * Float(scene.Lights().Size())))];
        const ShapePrimitive at = light.Surface();
        const std::optional<ShapeSample> place = at.shape->SampleArea(at.primitive, rng.Uniform2());
        if (!place) continue;
        LightSampleContext from;
        from.p = PointThatSees(place->p, Outwards(place->n, place->p - center, size), size, rng);
        const std::optional<LightLiSample> to =
            light.SampleLi(from, rng.Uniform2(), SampledWavelengths::SampleVisible(.5f), false);
        // Of a curved surface other points may lie at the horizon, or beyond it by rounding.
        if (to && AbsDot(to->nLight, to->wi) > Float(5e-4) &&
            Dot(Outwards(to->nLight, to->pLight - center, size), to->wi) < 0)
            Count(scene, from, *to, &count);
    }
    return count;
}

void ExpectNoneBlocked(const Placement &at) {
    const std::string lamp = "AreaLightSource 'diffuse' 'rgb L' [ 1 1 1 ] 'bool twosided' true";
    for (const ConvexShape &shape : kShapes)
        for (const bool isLight : {true, false}) {
            if (isLight && at.instanced) continue;
            const std::string place =
                fmt::format("Translate {0} Scale {1} {1} {1} Rotate 35 1 2 3 ", at.Points({.1, .2, .3}), at.Length(1));
            const Objects object = at.instanced
                                       ? Objects().Add(fmt::format("ObjectBegin 'o' {} ObjectEnd {} ObjectInstance 'o'",
                                                                   shape.text, place))
                                       : Objects().Add(place).Add(isLight ? lamp : "").Add(shape.text);
            const std::string text = ViewText(at, {"path"}, {0, 0, 9, 0, 0, 0, 0, 1, 0}, 90, 1, object);
            const BuiltScene built = BuildText(text);
            Rng rng(7);
            const Blocked count = isLight ? ConnectToSamples(*built.scene, rng) : ConnectToHits(*built.scene, rng);
            EXPECT_EQ(count.blocked, 0) << at.Name() << ", " << shape.name << (isLight ? " as light" : "");
            EXPECT_GT(count.segments, 500) << shape.name;
        }
}

TEST(Targets, DoNotHideThemselves) {
    for (const double scale : {1e-8, 1e-4, 1., 1e4, 1e8})
        for (const bool instanced : {false, true}) ExpectNoneBlocked({.scale = scale, .instanced = instanced});
}

TEST(Targets, DoNotHideThemselvesFarAway) {
    for (const char *system : {"cameraworld", "camera", "world"})
        for (const double scale : {100., 1e4})
            for (const bool instanced : {false, true})
                ExpectNoneBlocked(
                    {.scale = scale, .offset = {1e6, -1e6, 1e6}, .renderCoordSys = system, .instanced = instanced});
}

}  // namespace
}  // namespace pbrt::test
