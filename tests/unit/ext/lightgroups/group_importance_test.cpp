#include "ext/lightgroups/emitter.h"

#include <gtest/gtest.h>

#include "pbrt/lights/environment_light.h"
#include "pbrt/math/rng.h"
#include "support/build_text.h"
#include "support/light_query.h"
#include "support/scene_text.h"

namespace {

using namespace ext;
using test::Objects, test::SceneText;

const std::string kAssets = PBRT_SOURCE_DIR "/tests/conformance/suite/scenes/assets/";

/// One light of every kind, some as meshes, and a surface that they light.
const std::string kLights =
    SceneText()
        .Camera("perspective")
        .World(
            Objects()
                .Sphere(0.05)
                .Light("point", "'point3 from' [ 1 2 0 ] 'float scale' 3")
                .Light("spot",
                       "'point3 from' [ -1 2 0 ] 'point3 to' [ 0 0 1 ] 'float coneangle' 40 'float conedeltaangle' 25")
                .Light("distant", "'point3 from' [ 0 3 1 ] 'point3 to' [ 0 0 0 ]")
                .Sky("0.2 0.3 0.4")
                .Attribute("", Objects().AreaLight("4 4 4").Triangles(
                                   "-0.5 1.9 -0.5  0.5 1.9 -0.5  0.5 1.9 0.5  -0.5 1.9 0.5"))
                .Attribute(
                    "",
                    Objects().AreaLight("4 4 4", "'bool twosided' true").Quad("2 0 -0.5  2 0 0.5  2 1 -0.5  2 1 0.5"))
                .Attribute("Translate -1.5 0.5 0.5", Objects().AreaLight("4 4 4").Sphere(0.2))
                .Attribute("", Objects().AreaLight("9 2 2").Triangles(
                                   "0 0.2 1.5  0.2 0 1.5  0 -0.2 1.5  -0.2 0 1.5  0 0 1.7  0 0 1.3",
                                   "0 1 4 1 2 4 2 3 4 3 0 4 1 0 5 2 1 5 3 2 5 0 3 5"))
                .Light("infinite",
                       "'string filename' '" + kAssets +
                           "env_sky.exr' 'point3 portal' [ -1 -0.5 -2.5  1.2 -0.5 -2.5  1.2 1 -2.5  -1 1 -2.5 ]")
                .Light("infinite",
                       "'rgb L' [ 1 1 1 ] 'point3 portal' [ -0.6 2 0.1  -0.6 2 -0.4  -0.2 2 -0.4  -0.2 2 0.1 ]")
                .Attribute("Translate 0.5 1 -0.5 Rotate 30 1 1 0",
                           Objects().Light("goniometric",
                                           "'string filename' '" + kAssets + "gonio_lobes.png' 'rgb I' [ 3 2 1 ]"))
                .Attribute("Translate -0.5 1 -1.5 Rotate 20 1 -1 0",
                           Objects().Light("projection", "'string filename' '" + kAssets +
                                                             "slide.png' 'float fov' 50 'float scale' 5")));

LightQuery RandomQuery(Rng &rng) {
    LightQuery q;
    auto coordinate = [&] { return 4 * rng.Uniform() - 2; };
    q.p = Point3(coordinate(), coordinate(), coordinate());
    auto direction = [&] {
        Float z = 2 * rng.Uniform() - 1, phi = 2 * Pi * rng.Uniform(), r = SafeSqrt(1 - z * z);
        return Vector3(r * std::cos(phi), r * std::sin(phi), z);
    };
    q.wo = direction();
    if (rng.Uniform() < 0.8f) q.n = q.ns = direction();
    q.transmits = rng.Uniform() < 0.2f;
    return q;
}

std::optional<LightBounds> OpeningOf(const LightTable &lights, LightId light) {
    const EnvironmentLight *environment = lights[light].Parent().AsEnvironment();
    return environment ? environment->Opening() : std::nullopt;
}

std::vector<LightId> Skies(const LightTable &lights) {
    std::vector<LightId> skies;
    for (uint32_t i = 0; i < lights.Size(); ++i)
        if (lights[LightId(i)].Kind() == LightKind::Infinite) skies.emplace_back(i);
    return skies;
}

/// The radiance that one light sample brings to the point if nothing occludes it; 0 for the far side of an opaque
/// surface.
Float Unoccluded(const LightTable &lights, LightId light, const LightQuery &q, const Point2 &u) {
    LightSampleContext from{q.p, Vector3(0), q.n, q.ns, 0};
    std::optional<LightLiSample> s = lights[light].SampleLi(from, u, SampledWavelengths::WholeRange(), true);
    if (!s || !(s->pdf > 0)) return 0;
    Float cosine = q.ns == Normal3(0) ? Float(1) : AbsDot(s->wi, q.ns);
    if (q.ns != Normal3(0) && !q.transmits && Dot(s->wi, q.ns) * Dot(q.wo, q.ns) <= 0) return 0;
    return Float(RootMeanSquare(s->L) * double(cosine) / double(s->pdf) / lights.Unit());
}

class GroupImportanceOfEveryLight : public testing::TestWithParam<bool> {};

TEST_P(GroupImportanceOfEveryLight, IsPositiveWhereALightContributes) {
    BuiltScene built = pbrt::test::BuildText(kLights);
    const LightTable &lights = built.scene->Lights();
    const LightGroups &groups = GetParam() ? lights.ByLight() : lights.ByComponent();
    GroupImportance importance(groups);
    Rng rng(5);
    std::vector<Float> g(importance.Padded());
    std::vector<size_t> found(lights.Size());
    for (int i = 0; i < 4000; ++i) {
        LightQuery q = RandomQuery(rng);
        importance.Evaluate(q, g);
        for (uint32_t l = 0; l < lights.Size(); ++l)
            for (int k = 0; k < 4; ++k) {
                if (!(Unoccluded(lights, LightId(l), q, rng.Uniform2()) > 0)) continue;
                ++found[l];
                EXPECT_GT(g[groups.GroupOf(LightId(l))], 0) << "light " << l << " query " << i;
            }
    }
    for (uint32_t l = 0; l < lights.Size(); ++l) {
        // A sky of one colour is not sampled as a light; BSDF sampling finds it.
        bool never = lights[LightId(l)].Kind() == LightKind::Infinite && !OpeningOf(lights, LightId(l));
        EXPECT_EQ(found[l] > 100, !never) << "light " << l;
    }
}
INSTANTIATE_TEST_SUITE_P(GroupedOrNot, GroupImportanceOfEveryLight, testing::Bool());

TEST(GroupImportance, OneGroupAndAllGroupsHaveTheSameNumbers) {
    const BuiltScene built = test::BuildText(kLights);
    const GroupImportance importance(built.scene->Lights().ByComponent());
    ASSERT_GT(importance.Size(), 8u);
    Rng rng(6);
    for (int i = 0; i < 200; ++i) {
        LightQuery q = RandomQuery(rng);
        std::vector<Float> all(importance.Padded());
        Float sum = importance.Evaluate(q, all), added = 0;
        for (uint32_t l = 0; l < importance.Size(); ++l) {
            EXPECT_EQ(importance.Of(q, l), all[l]);
            added += all[l];
        }
        EXPECT_NEAR(sum, added, 1e-5f * added);
    }
}

class GroupImportanceByLight : public testing::Test {
  protected:
    const BuiltScene built_ = test::BuildText(kLights);
    const LightTable &lights_ = built_.scene->Lights();
    const LightGroups &groups_ = lights_.ByLight();
    const GroupImportance importance_{groups_};
};

TEST_F(GroupImportanceByLight, IsAnEstimateOfTheUnoccludedLight) {
    // Away from the emitters and above their horizon, G agrees with the irradiance up to a factor.
    const LightQuery q = test::QueryAt({0.3f, -1, 0.2f}, {0, 1, 0});
    std::vector<Float> g(importance_.Padded());
    importance_.Evaluate(q, g);
    Rng rng(7);
    std::vector<double> truth(groups_.Size(), 0);
    for (uint32_t l = 0; l < lights_.Size(); ++l) {
        const int n = 4096;
        for (int k = 0; k < n; ++k)
            truth[groups_.GroupOf(LightId(l))] += double(Unoccluded(lights_, LightId(l), q, rng.Uniform2())) / n;
    }
    size_t compared = 0;
    for (uint32_t i = 0; i < groups_.Size(); ++i) {
        if (!(truth[i] > 0)) continue;
        ++compared;
        EXPECT_LT(double(g[i]), 4 * truth[i]) << i;
        EXPECT_GT(double(g[i]), truth[i] / 4) << i;
    }
    EXPECT_GE(compared, 5u);
}

TEST_F(GroupImportanceByLight, LightsThatAreNeverSampledHaveNone) {
    const LightQuery q = test::QueryAt(Point3(0), {0, 1, 0});
    for (LightId sky : Skies(lights_))
        if (!OpeningOf(lights_, sky)) {
            EXPECT_EQ(importance_.Of(q, groups_.GroupOf(sky)), 0);
        }
}

TEST_F(GroupImportanceByLight, APortalIsALightInItsPlace) {
    size_t portals = 0;
    for (LightId sky : Skies(lights_)) {
        auto opening = OpeningOf(lights_, sky);
        if (!opening) continue;
        ++portals;
        const uint32_t group = groups_.GroupOf(sky);
        const auto at = [&](Float distance) {
            return importance_.Of(test::QueryAt(opening->Centroid() + opening->w * distance), group);
        };
        EXPECT_GT(at(3), 0);
        EXPECT_NEAR(at(6) / at(3), 0.25f, 0.05f) << "the importance must fall with the square of the distance";
        EXPECT_EQ(at(-5), 0) << "the portal sends no light to the outside";
        EXPECT_NEAR(Dot(importance_.DirectionTo(opening->Centroid() + opening->w * Float(2), group), -opening->w), 1,
                    1e-5f);
    }
    EXPECT_EQ(portals, 2u);
}

}  // namespace
