#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <numeric>

#include "ext/baselines/spatial/spatial_light_sampler.h"
#include "pbrt/core/parallel.h"
#include "support/build_text.h"
#include "support/errors.h"
#include "support/light_query.h"
#include "support/scene_text.h"

namespace {

using namespace ext;
using pbrt::test::BuildText, pbrt::test::FloorAndCeiling, pbrt::test::Objects, pbrt::test::QueryAt,
    pbrt::test::SceneText;

/// The inside of an 8 x 4 x 4 room; the camera stands at the origin, so rendering space is world space.
std::string Room(const std::string &world) {
    return SceneText()
        .Camera("perspective")
        .Film(16, 12)
        .Samples(1)
        .Integrator("path")
        .World(FloorAndCeiling(4, 2, 2).Add(world));
}
const std::string kLights =
    Objects()
        .PointLight("-3 1 0", "2 2 2")
        .PointLight("3 1 0", "7 7 7")
        .Attribute("", Objects().AreaLight("5 5 5").Triangles("-1 1.5 -1  1 1.5 -1  1 1.5 1  -1 1.5 1"))
        .Light("distant", "'point3 from' [ 0 1 1 ] 'point3 to' [ 0 0 0 ] 'rgb L' [ 1 1 1 ]");

struct Prepared {
    BuiltScene built;
    std::unique_ptr<SpatialLightSampler> sampler;
};
Prepared Prepare(const std::string &text, SpatialParams params = {}, int seed = 0) {
    Prepared r;
    r.built = BuildText(text);
    r.sampler = std::make_unique<SpatialLightSampler>(r.built.scene->Lights(), params);
    r.built.seed = seed;
    test::PrepareIn(r.built, *r.sampler);
    return r;
}
constexpr SpatialParams kCoarse{.voxels = 8};

TEST(Spatial, ContributionIsEquation3) {
    Prepared s = Prepare(Room(kLights), kCoarse);
    const LightTable &lights = s.built.scene->Lights();
    const VoxelGrid &grid = s.sampler->Grid();
    EXPECT_EQ(grid.Resolution(), glm::ivec3(8, 4, 4));
    for (const Point3 &p : {Point3(-3.9f, -1.9f, -1.9f), Point3(0.1f, -0.5f, 0.5f), Point3(3.5f, -1.5f, 1.5f)}) {
        uint32_t voxel = grid.Index(p);
        std::vector<double> f = s.sampler->UnshadowedContributions(voxel);
        ASSERT_EQ(f.size(), 4u);  // the mesh, which is one light, and the others in the order of the file
        // The slow twin: many random points, every triangle, Le G / p by area.
        std::vector<double> mean(4, 0.0);
        const int n = 40000;
        Rng rng(8);
        for (int i = 0; i < n; ++i) {
            const Point3 from = grid.PointIn(voxel, Vector3{rng.Uniform(), rng.Uniform(), rng.Uniform()});
            mean[1] += 2 / double(DistanceSquared(from, {-3, 1, 0})) / n;
            mean[2] += 7 / double(DistanceSquared(from, {3, 1, 0})) / n;
            Point3 onQuad(2 * rng.Uniform() - 1, 1.5f, 2 * rng.Uniform() - 1);
            double d2 = double(DistanceSquared(from, onQuad));
            double cosine = double(std::abs(onQuad.y - from.y)) / std::sqrt(d2);
            mean[0] += 5 * 4 * cosine / d2 / n;
            mean[3] += 1.0 / n;
        }
        // The lights scale their spectra, so each is compared with its own radiance straight below it.
        auto unit = [&](uint32_t light, const Point3 &seenFrom, double analytic) {
            auto li =
                lights[LightId(light)].SampleLi({.p = seenFrom}, {0.5f, 0.5f}, SampledWavelengths::WholeRange(), true);
            return RootMeanSquare(li->L) / analytic;
        };
        double point = unit(2, {-3, 0, 0}, 2), other = unit(3, {3, 0, 0}, 7), area = unit(0, {0, 0, 0}, 5);
        double distant = unit(4, {0, 0, 0}, 1);
        EXPECT_NEAR(f[1] / (point * mean[1]), 1, 0.02);
        EXPECT_NEAR(f[2] / (other * mean[2]), 1, 0.02);
        EXPECT_NEAR(f[3] / (distant * mean[3]), 1, 0.001);
        EXPECT_NEAR(f[0] / (area * mean[0]), 1, 0.05);
    }
}

TEST(Spatial, ProbabilityIsTheContributionOverItsSumWithAFloor) {
    Prepared s = Prepare(Room(kLights), {.voxels = 8, .floor = 0.3f});
    Point3 p(-3.5f, 0.5f, 0.5f);
    std::vector<double> f = s.sampler->UnshadowedContributions(s.sampler->Grid().Index(p));
    double floor = 0.3 * std::accumulate(f.begin(), f.end(), 0.0) / 4, sum = 0;
    EXPECT_LT(*std::min_element(f.begin(), f.end()), floor);
    for (double &v : f) sum += v = std::max(v, floor);
    auto pmf = [&](uint32_t light) { return double(s.sampler->PMF(QueryAt(p), LightId(light))); };
    EXPECT_NEAR(pmf(0) + pmf(1), f[0] / sum, 1e-6);
    EXPECT_NEAR(pmf(0), pmf(1), 1e-6);
    for (uint32_t i = 1; i < 4; ++i) EXPECT_NEAR(pmf(i + 1), f[i] / sum, 1e-6);
}

TEST(Spatial, ALightThatGivesNothingKeepsAThousandthOfTheMean) {
    std::string spot = R"(LightSource "spot" "point3 from" [ 0 3 0 ] "point3 to" [ 0 9 0 ] "rgb I" [ 100 100 100 ])";
    Prepared s = Prepare(Room(kLights + spot), kCoarse);
    for (const Point3 &p : {Point3(-3.5f, 0.5f, 0.5f), Point3(0.5f), Point3(3, -1, -1)}) {
        std::vector<double> f = s.sampler->UnshadowedContributions(s.sampler->Grid().Index(p));
        EXPECT_EQ(f[4], 0);
        EXPECT_NEAR(s.sampler->PMF(QueryAt(p), LightId(5u)), 0.001f / 5 / 1.001f, 3e-6f);
    }
}

TEST(Spatial, NeitherNormalsNorOccludersMatter) {
    // A wall between the halves, which does not enlarge the bounds.
    std::string wall = R"(Shape "bilinearmesh" "point3 P" [ 0 -2 -2  0 2 -2  0 -2 2  0 2 2 ])";
    Prepared open = Prepare(Room(kLights), kCoarse);
    Prepared walled = Prepare(Room(wall + "\n" + kLights), kCoarse);
    LightQuery q = QueryAt({-2, -1, 0.5f}), turned = q;
    turned.n = turned.ns = Normal3(0, 0, 1);
    for (uint32_t i = 0; i < 5; ++i) {
        EXPECT_EQ(open.sampler->PMF(q, LightId(i)), walled.sampler->PMF(q, LightId(i)));
        EXPECT_EQ(open.sampler->PMF(q, LightId(i)), open.sampler->PMF(turned, LightId(i)));
    }
}

TEST(Spatial, AVoxelDependsOnTheVoxelAndTheSeedOnly) {
    Prepared a = Prepare(Room(kLights), kCoarse), b = Prepare(Room(kLights), kCoarse);
    Prepared other = Prepare(Room(kLights), kCoarse, 1);
    const VoxelGrid &grid = a.sampler->Grid();
    const auto n = int64_t(grid.Size());
    auto place = [&](int64_t i) { return QueryAt(grid.PointIn(uint32_t(i), Vector3(0.5f))); };
    {
        ThreadLimit limit(4);
        ParallelFor(n, 1, [&](int64_t begin, int64_t end) {
            for (int64_t i = begin; i < end; ++i) a.sampler->PMF(place(i), LightId(0u));
        });
    }
    int different = 0;
    for (int64_t i = n; i-- > 0;)
        for (uint32_t light = 0; light < 5; ++light) {
            ASSERT_EQ(a.sampler->PMF(place(i), LightId(light)), b.sampler->PMF(place(i), LightId(light)));
            different += a.sampler->PMF(place(i), LightId(light)) != other.sampler->PMF(place(i), LightId(light));
        }
    EXPECT_GT(different, n);
}

TEST(Spatial, OnlyQueriedVoxelsAreFilled) {
    Prepared s = Prepare(Room(kLights));
    EXPECT_EQ(s.sampler->Grid().Resolution(), glm::ivec3(64, 32, 32));
    s.sampler->Sample(QueryAt({1, 1, 1}), 0.3f);
    s.sampler->PMF(QueryAt({1, 1, 1}), LightId(2u));
    s.sampler->Sample(QueryAt({-100, 0, 0}), 0.3f);  // a point outside of the grid takes the nearest voxel
    nlohmann::ordered_json report;
    s.sampler->Report(report);
    EXPECT_EQ(report["voxelsFilled"], 2);
    EXPECT_EQ(report["voxels"], 64 * 32 * 32);
    EXPECT_EQ(s.sampler->PMF(QueryAt({-100, 0, 0}), LightId(0u)),
              s.sampler->PMF(QueryAt({-3.99f, 0.01f, 0.01f}), LightId(0u)));
    test::ExpectWords(s.sampler->DescribeStructure(), {"2 of 65536 voxels"});
}

TEST(Spatial, InspectNamesTheStrongestLight) {
    Prepared s = Prepare(Room(kLights), kCoarse);
    auto inspect = [&](const Point3 &p) {
        std::vector<InspectedValue> v;
        s.sampler->Inspect(QueryAt(p), v);
        return v;
    };
    std::vector<InspectedValue> left = inspect({-3, 0.5f, 0.1f}), right = inspect({3, 0.5f, 0.1f});
    ASSERT_EQ(left.size(), 3u);
    EXPECT_NE(left[0].value, right[0].value);
    EXPECT_EQ(left[1].value, 1);
    EXPECT_EQ(right[1].value, 2);
    EXPECT_GT(right[2].value, 0.4);
    for (size_t i = 0; i < 3; ++i) EXPECT_EQ(left[i].name, right[i].name);
}

}  // namespace
