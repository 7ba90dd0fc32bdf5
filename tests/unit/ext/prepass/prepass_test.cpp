#include <gtest/gtest.h>

#include "ext/prepass/prepass.h"
#include "pbrt/core/parallel.h"
#include "support/build_text.h"
#include "support/scene_text.h"

namespace {

using namespace ext;
using pbrt::test::BuildText, pbrt::test::Objects, pbrt::test::SceneText;

BuiltScene BuildFloor() {
    return BuildText(SceneText()
                         .LookAt("0 1 -4  0 1 0  0 1 0")
                         .Camera(50)
                         .Film(40, 30)
                         .Samples(1)
                         .Integrator("path")
                         .World(Objects()
                                    .PointLight("0 1.5 0", "1 1 1")
                                    .PointLight("0 1.5 5", "1 1 1")
                                    .Material("diffuse")
                                    .Quad("-4 0 -4  4 0 -4  -4 0 4  4 0 4")
                                    .Quad("-4 0 2  4 0 2  -4 4 2  4 4 2")
                                    .Material("conductor", "'float roughness' 0")
                                    .Attribute("Translate 0 0.6 0", Objects().Sphere(0.5))));
}

std::vector<PrepassVertex> Trace(int threads, int spp, int depth) {
    ThreadLimit limit(threads);
    BuiltScene built = BuildFloor();
    Progress progress;
    PrepareContext context = built.Preparation(progress);
    return TracePrepassPaths(context, spp, depth);
}

TEST(Prepass, RecordsAreTheSameForAnyNumberOfThreads) {
    std::vector<PrepassVertex> one = Trace(1, 2, 3), many = Trace(3, 2, 3);
    ASSERT_EQ(one.size(), many.size());
    ASSERT_GT(one.size(), 500u);
    for (size_t i = 0; i < one.size(); ++i) {
        EXPECT_EQ(one[i].at.p, many[i].at.p);
        EXPECT_EQ(one[i].wo, many[i].wo);
    }
}

TEST(Prepass, DepthAndSamplesBoundTheNumberOfVertices) {
    EXPECT_LE(Trace(2, 1, 1).size(), 40u * 30u);
    EXPECT_LE(Trace(2, 3, 2).size(), 40u * 30u * 6u);
    EXPECT_GT(Trace(2, 1, 3).size(), Trace(2, 1, 1).size());
}

TEST(Prepass, MirrorsAreNotRecorded) {
    // The sphere is specular, so no vertex may lie on it: check the distance from its centre.
    for (const PrepassVertex &v : Trace(2, 4, 3)) {
        Point3 centre(0, 0.6f - 1, 4);  // rendering space: the camera is at the origin
        EXPECT_GT(std::abs(Distance(v.at.p, centre) - 0.5f), 1e-3f);
    }
}

TEST(Prepass, ContributionIsEquation5) {
    ThreadLimit limit(1);
    BuiltScene built = BuildFloor();
    // A point on the floor below the first light, seen from above; the second light is behind the wall.
    PrepassVertex v;
    v.at.p = Point3(2, -1, 4);
    v.at.pError = Vector3(1e-5f);
    v.at.n = v.at.ns = Normal3(0, 1, 0);
    v.wo = Vector3(0, 1, 0);
    const double seen = VisibleContribution(*built.scene, v, built.scene->Lights()[LightId(0u)], {0.5f, 0.5f});
    EXPECT_GT(seen, 0);
    EXPECT_EQ(VisibleContribution(*built.scene, v, built.scene->Lights()[LightId(1u)], {0.5f, 0.5f}), 0);
    // A point light contributes I cos / d^2, so the value at another distance and angle scales by exactly that.
    PrepassVertex w = v;
    w.at.p = Point3(3, -1, 4);
    auto geometry = [](double x) { return 1.5 / std::pow(x * x + 1.5 * 1.5, 1.5); };
    const double other = VisibleContribution(*built.scene, w, built.scene->Lights()[LightId(0u)], {0.5f, 0.5f});
    EXPECT_NEAR(other / seen, geometry(3) / geometry(2), 1e-3);
    // Seen from below, the floor reflects nothing, unless its surface transmits (the sphere does not block that light
    // either).
    v.wo = Vector3(0, -1, 0);
    EXPECT_EQ(VisibleContribution(*built.scene, v, built.scene->Lights()[LightId(0u)], {0.5f, 0.5f}), 0);
    v.transmits = true;
    EXPECT_GT(VisibleContribution(*built.scene, v, built.scene->Lights()[LightId(0u)], {0.5f, 0.5f}), 0);
}

}  // namespace
