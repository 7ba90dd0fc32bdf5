#include "ext/lightgroups/mesh_interior.h"

#include <gtest/gtest.h>

#include "support/build_text.h"
#include "support/light_query.h"
#include "support/scene_text.h"

namespace {

using namespace ext;

/// An emitting sphere of `rings` by `rings` quads, each cut into two triangles.
std::string Ball(int rings) {
    std::string p, indices;
    for (int i = 0; i <= rings; ++i)
        for (int k = 0; k < rings; ++k) {
            double theta = 3.14159265 * (0.02 + 0.96 * i / rings), phi = 2 * 3.14159265 * k / rings;
            p += fmt::format("{} {} {} ", std::sin(theta) * std::cos(phi), std::cos(theta),
                             std::sin(theta) * std::sin(phi));
        }
    for (int i = 0; i < rings; ++i)
        for (int k = 0; k < rings; ++k) {
            int a = i * rings + k, b = i * rings + (k + 1) % rings;
            indices += fmt::format("{} {} {} {} {} {} ", a, b, b + rings, a, b + rings, a + rings);
        }
    return test::SceneText().Camera("perspective").World(test::Objects().AreaLight("1 1 1").Triangles(p, indices));
}

class MeshInteriorOfSize : public testing::TestWithParam<int> {
  protected:
    /// Above the ball, facing down.
    LightQuery Above(const Vector3 &fromCenter) const {
        return test::QueryAt(built_.scene->Bounds().Center() + fromCenter, {0, -1, 0});
    }
    const BuiltScene built_ = test::BuildText(Ball(GetParam()));
    const LightTable &lights_ = built_.scene->Lights();
    const MeshInterior interior_{lights_.ByLight()};
};

TEST_P(MeshInteriorOfSize, SamplesFollowThePmf) {
    ASSERT_EQ(lights_.ByLight().Size(), 1u);
    const LightQuery q = Above({0.4f, 2.2f, 0.3f});

    std::vector<double> expected(lights_.Size()), observed(lights_.Size(), 0.0);
    double sum = 0;
    const int n = 40000;
    for (uint32_t l = 0; l < lights_.Size(); ++l) {
        sum += double(interior_.PMF(q, LightId(l)));
        expected[l] = n * double(interior_.PMF(q, LightId(l)));
    }
    // A cluster of the tree can have importance although none of its members has: then no light is chosen.
    EXPECT_LE(sum, 1.0001);
    EXPECT_GT(sum, 0.95);
    double missed = 0;
    for (int i = 0; i < n; ++i) {
        std::optional<SampledLight> s = interior_.Sample(0, q, (Float(i) + 0.5f) / n);
        if (!s) {
            ++missed;
            continue;
        }
        EXPECT_EQ(s->pmf, interior_.PMF(q, s->light));
        ++observed[s->light.value];
    }
    EXPECT_NEAR(missed, n * (1 - sum), 3 + 1e-3 * n);
    // With equidistant random numbers, the counts follow the probabilities up to rounding at the borders.
    for (size_t l = 0; l < lights_.Size(); ++l) EXPECT_NEAR(observed[l], expected[l], 3 + 1e-3 * expected[l]);
}

TEST_P(MeshInteriorOfSize, PrefersWhatFacesThePoint) {
    const LightQuery q = Above({0, 3, 0});
    double facing = 0;
    for (uint32_t l = 0; l < lights_.Size(); ++l)
        if (lights_.Candidate(LightId(l)).bounds->Centroid().y > built_.scene->Bounds().Center().y)
            facing += double(interior_.PMF(q, LightId(l)));
    EXPECT_GT(facing, 0.97);
}
INSTANTIATE_TEST_SUITE_P(ScanAndTree, MeshInteriorOfSize, testing::Values(4, 10));

}  // namespace
