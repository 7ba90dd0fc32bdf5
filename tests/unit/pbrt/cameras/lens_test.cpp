// The pieces of the realistic camera: lens files, tracing, focus, apertures, exit pupils.
#include "camera_cases.h"
#include "lens_cases.h"
#include "support/errors.h"
#include "support/temporary_image.h"

namespace pbrt::test {
namespace {

struct Traced {
    glm::dvec3 o, d;
    bool passes = false;
};

/// The reference for LensSystem::Trace: in double precision, with spheres given by their centres and refraction by
/// angles.
Traced TraceSlowly(const std::vector<LensElement> &elements, glm::dvec3 o, glm::dvec3 d) {
    double z = 0;
    for (size_t i = elements.size(); i-- > 0;) {
        const LensElement &e = elements[i];
        z += double(e.thickness);
        if (e.IsStop()) {
            o += d * ((z - o.z) / d.z);
            if (std::hypot(o.x, o.y) > double(e.apertureRadius)) return {};
            continue;
        }
        const double radius = double(e.curvatureRadius);
        const glm::dvec3 center(0, 0, z - radius);
        const double toClosest = glm::dot(center - o, d), gap = glm::length(o + d * toClosest - center);
        if (gap >= std::abs(radius)) return {};
        const double half = std::sqrt(radius * radius - gap * gap);
        // The ray meets a surface that is convex towards the scene where it leaves the sphere.
        const double t = radius > 0 ? toClosest + half : toClosest - half;
        if (t < 0) return {};
        o += d * t;
        if (std::hypot(o.x, o.y) > double(e.apertureRadius)) return {};
        const glm::dvec3 normal = glm::normalize(o - center) * (radius > 0 ? 1.0 : -1.0);
        const double before = double(e.index), behind = i > 0 ? double(elements[i - 1].index) : 1;
        const glm::dvec3 across = d - normal * glm::dot(normal, d);
        const double angle = std::atan2(glm::length(across), glm::dot(normal, d));
        if (before * std::sin(angle) >= behind) return {};
        const double refracted = std::asin(before * std::sin(angle) / behind);
        if (glm::length(across) > 1e-12)
            d = normal * std::cos(refracted) + glm::normalize(across) * std::sin(refracted);
    }
    return {o, d, true};
}

TEST(LensSystem, RaysGoWhereTheSlowTwinSendsThem) {
    for (std::vector<LensElement> elements : {DoubleGauss(), FishEye()}) {
        const LensSystem lens(elements);
        Rng rng(1);
        int passed = 0, differ = 0;
        constexpr int kRays = 20000;
        for (int i = 0; i < kRays; ++i) {
            const Point2 film = RandomInSquare(rng, 0.02f);
            Ray ray = FromFilm(film, RandomInSquare(rng, lens.RearRadius()), lens);
            const Traced slow = TraceSlowly(elements, glm::dvec3(ray.o), glm::dvec3(ray.d));
            const Float weight = lens.Trace(&ray);
            differ += slow.passes != (weight > 0);
            if (!slow.passes || weight == 0) continue;
            EXPECT_EQ(weight, 1);
            ++passed;
            ASSERT_LT(glm::length(slow.o - glm::dvec3(ray.o)), 2e-7);
            ASSERT_LT(glm::length(slow.d - glm::dvec3(ray.d)), 1e-5);
            ASSERT_NEAR(Length(ray.d), 1, 1e-6f);
        }
        EXPECT_GT(passed, kRays / 20);
        EXPECT_LE(differ, 3) << "more rays differ than rounding at the border explains";
    }
}

TEST(LensSystem, ThinLensSendsFilmPointsThroughTheirImages) {
    // f = 50 mm; the film, 60 mm behind the lens, sees a plane 300 mm in front of it, upside down and 5 times as large.
    std::vector<LensElement> elements = ThinLens(0.05f, 0.003f);
    elements.back().thickness = 0.06f;
    const LensSystem lens(elements);
    Rng rng(2);
    for (int i = 0; i < 300; ++i) {
        const Point2 film = RandomInSquare(rng, 0.003f);
        Ray ray = FromFilm(film, RandomInSquare(rng, 0.002f), lens);
        ASSERT_GT(lens.Trace(&ray), 0);
        ExpectClose(AtDepth(ray, 0.06f + 0.3f), Point3(film * Float(-5), 0.36f), 3e-4f);
    }
}

TEST(FocusedThickness, ThinLensObeysTheLensEquation) {
    for (double distance : {0.21, 0.5, 3.0, 100.0}) {
        const double s = FocusedThickness(ThinLens(0.05f, 0.001f), distance).value();
        EXPECT_NEAR(1 / s + 1 / (distance - s), 1 / 0.05, 2e-3) << distance;
        EXPECT_LE(s, distance / 2 + 1e-6) << "the film is on the shorter side";
    }
    EXPECT_FALSE(FocusedThickness(ThinLens(0.05f, 0.001f), 0.19)) << "closer than four focal lengths";
    EXPECT_FALSE(FocusedThickness(ThinLens(-0.05f, 0.001f), 3)) << "a diverging lens has no focus";
    const LensElement window{0, 0.001f, 1, 0.01f};
    EXPECT_FALSE(FocusedThickness(std::vector<LensElement>{window}, 3)) << "a stop alone has no focus";
}

TEST(FocusedThickness, RaysNearTheAxisMeetInThePlaneOfFocus) {
    for (std::vector<LensElement> elements : {DoubleGauss(), FishEye()})
        for (Float distance : {0.5f, 6.0f}) {
            elements.back().thickness = Float(FocusedThickness(elements, double(distance)).value());
            // The reference traces a ray from a point on the axis to where it crosses the axis again.
            const double rearZ = double(elements.back().thickness);
            const Traced t = TraceSlowly(elements, {0, 0, 0}, glm::normalize(glm::dvec3(1e-5, 0, rearZ)));
            ASSERT_TRUE(t.passes);
            EXPECT_NEAR(t.o.z - t.o.x / t.d.x * t.d.z, double(distance), 2e-3 * double(distance));
        }
}

TEST(ExitPupil, HoldsEveryRayThatPassesAndLittleMore) {
    for (std::vector<LensElement> elements : {DoubleGauss(), FishEye()}) {
        const LensSystem lens(elements);
        constexpr Float kFilmRadius = 0.02f;
        const ExitPupil pupil(lens, kFilmRadius);
        Rng rng(3);
        // Counts of all rays that pass and of those among them outside of the pupil's rectangle; sums of the
        // rectangle's area and of the area that passing rays stand for.
        int passed = 0, outside = 0;
        double area = 0, passedArea = 0;
        constexpr int kRays = 200000;
        for (int i = 0; i < kRays; ++i) {
            const Float distance = kFilmRadius * rng.Uniform();
            const Float side = 3 * lens.RearRadius();
            const Point2 p = RandomInSquare(rng, side / 2);
            Ray ray = FromFilm({distance, 0}, p, lens);
            const Bounds2 &b = pupil.Bounds(distance);
            area += double(b.Area());
            if (lens.Trace(&ray) == 0) continue;
            ++passed;
            passedArea += double(side * side);
            outside += !(p.x >= b.low.x && p.x <= b.high.x && p.y >= b.low.y && p.y <= b.high.y);
        }
        EXPECT_GT(passed, 2000);
        EXPECT_EQ(outside, 0);
        // A disk fills 0.79 of its square; a pupil cut by two rims fills about two thirds of its rectangle.
        EXPECT_LT(area / passedArea, 2) << "the rectangle is too large, so too many samples are wasted";
    }
}

TEST(ExitPupil, SamplesTurnWithTheFilmPointAndFillTheRectangle) {
    const LensSystem lens(DoubleGauss());
    const ExitPupil pupil(lens, 0.02f);
    for (Float angle : {0.f, 70.f, 200.f}) {
        const Point2 direction(std::cos(Radians(angle)), std::sin(Radians(angle)));
        const Point2 film = direction * 0.015f;
        const Bounds2 &b = pupil.Bounds(0.015f);
        EXPECT_NEAR(pupil.Pdf(film) * b.Area(), 1, 1e-5f);
        for (const Point2 &u : {Point2(0, 0), Point2(1, 1), Point2(0.3f, 0.8f)}) {
            const Point2 p = pupil.Sample(film, u);
            EXPECT_NEAR(glm::dot(p, direction), b.Lerp(u).x, 1e-6f);
            EXPECT_NEAR(p.y * direction.x - p.x * direction.y, b.Lerp(u).y, 1e-6f);
        }
    }
}

TEST(ExitPupil, TinyStopsHaveTinyPupils) {
    std::vector<LensElement> elements = DoubleGauss();
    for (LensElement &e : elements)
        if (e.IsStop()) e.apertureRadius = 0.0002f;
    const LensSystem lens(elements);
    const ExitPupil pupil(lens, 0.02f);
    for (Float distance : {0.f, 0.01f, 0.0199f}) EXPECT_LT(pupil.Bounds(distance).Area(), Sqr(0.0015f)) << distance;
}

ApertureImage ReadAperture(const std::string &name) { return ApertureImage::Read(name, FileResolver()); }

TEST(ApertureImage, LetsAsMuchLightPassAsTheDisk) {
    EXPECT_FALSE(ReadAperture(""));
    for (const char *name : {"gaussian", "square", "pentagon", "star"}) {
        const ApertureImage aperture = ReadAperture(name);
        double sum = 0, farthest = 0;
        constexpr int kSteps = 700;
        for (int y = 0; y < kSteps; ++y)
            for (int x = 0; x < kSteps; ++x) {
                const Point2 p = (Point2(x, y) + Point2(0.5f)) * (Float(2) / kSteps) - Point2(1);
                const double value = double(aperture.Lookup(p));
                sum += value * 4 / (kSteps * kSteps);
                if (value > 0) farthest = std::max(farthest, double(glm::length(p)));
            }
        EXPECT_NEAR(sum, std::numbers::pi, 0.01) << name;
        EXPECT_LE(farthest, double(aperture.Reach())) << name;
        EXPECT_GT(farthest, 0.95 * double(aperture.Reach())) << name;
        EXPECT_EQ(aperture.Lookup({1.1f, 0}), 0) << name;
        EXPECT_EQ(aperture.Lookup({0, -1.1f}), 0) << name;
    }
}

TEST(ApertureImage, ShapesHaveTheirCorners) {
    const ApertureImage square = ReadAperture("square"), pentagon = ReadAperture("pentagon"),
                        star = ReadAperture("star");
    EXPECT_GT(square.Lookup({0.48f, -0.48f}), 0);
    EXPECT_EQ(square.Lookup({0.52f, 0}), 0);
    // The pentagon has a corner at -y and a side at +y; the side is 0.8 cos 36 degrees = 0.647 from the centre, the
    // corners 0.8.
    EXPECT_GT(pentagon.Lookup({0, -0.78f}), 0);
    EXPECT_EQ(pentagon.Lookup({0, 0.67f}), 0);
    EXPECT_GT(pentagon.Lookup({0, 0.63f}), 0);
    // The star has points at 36, 108, 180, ... degrees and notches (at 0.382) between them.
    for (int i = 0; i < 10; ++i) {
        const Float angle = Radians(36 * Float(i));
        const Point2 direction(std::cos(angle), std::sin(angle));
        EXPECT_EQ(star.Lookup(direction * 0.45f) > 0, i % 2 == 1) << i;
        EXPECT_GT(star.Lookup(direction * 0.35f), 0) << i;
    }
}

TEST(ApertureImage, FilesAreAveragedAndTurnedUpsideDown) {
    Image rgb(PixelFormat::Float, {2, 2}, {"R", "G", "B"});
    for (int c = 0; c < 3; ++c) rgb.Set({0, 0}, c, Float(c));  // top left: mean 1
    rgb.Set({1, 1}, 0, 9);                                     // bottom right: mean 3
    const TemporaryImage file("aperture_test.exr", rgb);
    const ApertureImage aperture = ReadAperture(file.Path());
    EXPECT_NEAR(aperture.Lookup({0.5f, -0.5f}) / aperture.Lookup({-0.5f, 0.5f}), 3, 1e-3f);
    EXPECT_EQ(aperture.Lookup({-0.5f, -0.5f}), 0);
}

std::string LensError(const std::string &text) {
    const std::string path = WriteFile("lens_test.dat", text);
    return MessageOf([&] { ReadLensFile(path); });
}

TEST(LensFile, IsReadInMillimetresAndChecked) {
    const std::string path = WriteFile("lens_good.dat", "# a lens\n50 2 1.5 20 # front\n0 3 0 10\n-40 60\n1 22\n");
    const std::vector<LensElement> e = ReadLensFile(path);
    ASSERT_EQ(e.size(), 3u);
    EXPECT_FLOAT_EQ(e[0].curvatureRadius, 0.05f);
    EXPECT_FLOAT_EQ(e[0].thickness, 0.002f);
    EXPECT_FLOAT_EQ(e[0].index, 1.5f);
    EXPECT_FLOAT_EQ(e[0].apertureRadius, 0.01f);
    EXPECT_TRUE(e[1].IsStop());
    EXPECT_EQ(e[1].index, 1);
    EXPECT_FLOAT_EQ(e[2].curvatureRadius, -0.04f);
    ExpectWords(LensError("50 2 1.5"), {"four numbers"});
    ExpectWords(LensError(""), {"four numbers"});
    ExpectWords(LensError("50 2 1.5 20\n50 2 glass 20"), {":2: "});
    ExpectWords(LensError("50 -2 1.5 20"), {"thickness"});
    ExpectWords(LensError("50 2 0 20"), {"index"});
    ExpectWords(LensError("50 2 1 0"), {"diameter"});
}

}  // namespace
}  // namespace pbrt::test
