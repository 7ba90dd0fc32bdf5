// All light samplers of one scene give the same picture in the mean. Every scene is also rendered by samplers that are
// broken on purpose, which the same statistic must notice.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <regex>
#include <sstream>

#include "agreement_statistics.h"
#include "pbrt/integrators/path_integrator.h"
#include "support/build_text.h"
#include "support/render_scene.h"
#include "support/scene_text.h"
#include "support/statistics.h"
#include "support/threads.h"
#include "support/wrapped_sampler.h"
#include "table.h"

namespace pbrt::test {
namespace {

constexpr double kAlpha = 1e-3;  ///< false alarm anywhere in one scene, if the seeds were not fixed

bool HasOctree() { return AllSamplers().samplers.Has("octree"); }

/// All but the oracle, which would take most of the time (the contract suite has its one-light estimator). What
/// "spatial" does before rendering is cut down.
std::vector<std::string> Labels() {
    std::vector<std::string> labels = AllSamplers().samplers.Names();
    std::erase(labels, "oracle");
    std::ranges::replace(labels, std::string("spatial"), std::string("spatial:voxels=8,samples=64"));
    if (HasOctree())
        labels.insert(labels.end(), {"octree:model=paper", "octree:model=paper,leaves=64", "octree:floor=0.5,tries=2"});
    labels.push_back("bvh+meshlights");
    return labels;
}

/// The same without "uniform" and "power", which choose alike at every place; their labels are empty.
std::vector<std::string> LabelsThatDependOnThePlace() {
    std::vector<std::string> labels = Labels();
    for (const char *name : {"uniform", "power"}) std::ranges::replace(labels, std::string(name), std::string());
    return labels;
}

Table &kTable =
    AddTable("agreement", fmt::format("{:<14} {:<30} {:>8} {:>7}   {:>9} {:>9}  {:<13} {}", "scene", "sampler",
                                      "mean %", "+- %", "worst p", "level", "verdict", "worst tile"));

void AddRow(const std::string &scene, const std::string &sampler, const Agreement &a, const std::string &verdict) {
    kTable.Line(fmt::format("{:<14} {:<30} {:>+8.3f} {:>7.3f}   {:>9.2e} {:>9.2e}  {:<13} {}", scene, sampler,
                            100 * a.difference, 100 * a.error, a.worstP, a.level, verdict, a.worst));
}

using Change = TamperedSampler::Change;

/// A scene built once and rendered with many light samplers and seeds.
class View {
  public:
    View(BuiltScene built, int samplesPerPixel, int runs)
        : built_(std::move(built)), samplesPerPixel_(samplesPerPixel), runs_(runs) {}

    const Scene &GetScene() const { return *built_.scene; }
    /// The least powerful of the lights that only light sampling can find.
    LightId WeakestDelta() const {
        const LightTable &lights = GetScene().Lights();
        LightId weakest;
        for (uint32_t i = 0; i < lights.Size(); ++i)
            if (IsDelta(lights[LightId(i)].Kind()) &&
                (!weakest || lights.Candidate(LightId(i)).power < lights.Candidate(weakest).power))
                weakest = LightId(i);
        return weakest;
    }

    /// With an empty `change` the sampler is as it is.
    PixelStatistics Render(const std::string &label, int firstSeed, const Change &change = {}) const {
        size_t plus = label.find('+');
        const std::string choice = label.substr(0, plus) + (plus != std::string::npos ? "+mesh" : "");
        const bool media = GetScene().HasMedia();
        const PathSettings path{.maxDepth = built_.maxDepth, .passesInterfaces = media, .tracksMedia = media};
        PixelStatistics statistics;
        for (int run = 0; run < runs_; ++run) {
            std::unique_ptr<LightSampler> lights = MakeLightSampler(choice, GetScene().Lights());
            if (change) lights = std::make_unique<TamperedSampler>(std::move(lights), change);
            PathIntegrator integrator({GetScene(), *built_.camera, samplesPerPixel_, true}, path, std::move(lights));
            statistics.Add(RenderIndependently(built_, integrator, samplesPerPixel_, firstSeed + run));
        }
        return statistics;
    }

  private:
    BuiltScene built_;
    int samplesPerPixel_, runs_;
};

/// The text of a scene, stock's layered coats replaced: their estimator's mean depends on how lights are chosen.
std::string WithoutCoats(const std::string &file) {
    std::ifstream in(std::string(PBRT_SOURCE_DIR) + "/" + file);
    std::stringstream text;
    text << in.rdbuf();
    return std::regex_replace(text.str(), std::regex("Material \"coateddiffuse\"[^\n]*"),
                              "Material \"conductor\" \"float roughness\" 0.3");
}

/// All samplers against each other, but for empty labels. The renders are handed on, for the tests of power.
std::vector<PixelStatistics> ExpectAgreement(const std::string &name, const View &view,
                                             std::vector<std::string> labels = Labels()) {
    std::vector<PixelStatistics> renders;
    for (size_t i = 0; i < labels.size(); ++i)
        if (!labels[i].empty()) renders.push_back(view.Render(labels[i], 1000 * (int(i) + 1)));
    std::erase(labels, "");
    for (size_t i = 0; i < labels.size(); ++i) {
        std::vector<const PixelStatistics *> others;
        for (size_t k = 0; k < labels.size(); ++k)
            if (k != i) others.push_back(&renders[k]);
        Agreement a = Compare(renders[i], others, labels.size(), kAlpha);
        AddRow(name, labels[i], a, a.Agrees() ? "agrees" : "DISAGREES");
        EXPECT_TRUE(a.Agrees()) << labels[i] << ": p " << a.worstP << " at " << a.worst;
    }
    return renders;
}

/// The statistic sees what a broken sampler does.
void ExpectNoticed(const std::string &name, const std::string &what, const View &view,
                   const std::vector<PixelStatistics> &good, const std::string &label, const Change &change) {
    std::vector<const PixelStatistics *> others;
    for (const PixelStatistics &g : good) others.push_back(&g);
    Agreement a = Compare(view.Render(label, 500000, change), others, good.size(), kAlpha);
    AddRow(name, what, a, a.Agrees() ? "NOT NOTICED" : "noticed");
    EXPECT_FALSE(a.Agrees()) << what << ": p " << a.worstP;
}

/// With "floor=0.0001" of the paper's model: what the octree did not see gets nothing.
Float NoFloor(const LightQuery &, const SampledLight &s) { return s.pmf <= Float(1.01e-4) ? 0 : s.pmf; }
constexpr const char *kMinFloor = "octree:model=paper,floor=0.0001";

BuildOptions Reduced(int divisor) {
    BuildOptions options;
    options.film.resolutionDivisor = divisor;
    return options;
}

TEST(LightSamplersAgree, TwelveLights) {
    std::string file = "tests/conformance/suite/scenes/lightsamplers/twelve_lights_bvh.pbrt";
    View view(BuildFile(std::string(PBRT_SOURCE_DIR) + "/" + file), 16, 8);
    auto good = ExpectAgreement("twelve_lights", view);
    ExpectNoticed("twelve_lights", "bvh, 3 % off on one side", view, good, "bvh",
                  [](const LightQuery &q, const SampledLight &s) { return q.p.x > 0 ? s.pmf * Float(1.03) : s.pmf; });
    ExpectNoticed("twelve_lights", "bvh without one lamp", view, good, "bvh",
                  [lamp = view.WeakestDelta()](const LightQuery &, const SampledLight &s) {
                      return s.light == lamp ? 0 : s.pmf;
                  });
}

/// Lights in a chamber behind a folded passage. A prepass of one vertex sees none of them.
TEST(LightSamplersAgree, Deep) {
    View view(BuildText(WithoutCoats("scenes/deep/deep.pbrt"), Reduced(2)), 6, 8);
    std::vector<std::string> labels = LabelsThatDependOnThePlace();
    if (HasOctree()) labels.push_back("octree:depth=1");
    auto good = ExpectAgreement("deep", view, labels);
    if (HasOctree())
        ExpectNoticed("deep", "octree:depth=1 without floor", view, good, std::string(kMinFloor) + ",depth=1", NoFloor);
}

TEST(LightSamplersAgree, Slit) {
    View view(BuildText(WithoutCoats("tests/render/scenes/slit.pbrt"), Reduced(2)), 10, 8);
    auto good = ExpectAgreement("slit", view, LabelsThatDependOnThePlace());
    if (HasOctree())
        ExpectNoticed("slit", "octree without floor", view, good, std::string(kMinFloor) + ",leaves=65536", NoFloor);
}

TEST(LightSamplersAgree, RoomsFullOfFog) {
    View view(BuildFile(std::string(PBRT_SOURCE_DIR) + "/tests/render/scenes/fog.pbrt", Reduced(2)), 40, 8);
    auto good = ExpectAgreement("fog", view);
    ExpectNoticed(
        "fog", "bvh, a fifth off inside the fog", view, good, "bvh",
        [](const LightQuery &q, const SampledLight &s) { return q.ns == Normal3(0) ? s.pmf * Float(1.2) : s.pmf; });
}

TEST(LightSamplersAgree, Dollhouse) {
    View view(BuildText(WithoutCoats("scenes/dollhouse/dollhouse.pbrt"), Reduced(5)), 12, 8);
    std::vector<std::string> labels = Labels();
    if (HasOctree()) labels.push_back("octree:portals=always");
    auto good = ExpectAgreement("dollhouse", view, labels);
    if (HasOctree())
        ExpectNoticed("dollhouse", "octree:depth=1 without floor", view, good,
                      std::string(kMinFloor) + ",depth=1,leaves=65536", NoFloor);
}

/// An environment light sampled through portals, and through blinds and a curtain.
TEST(LightSamplersAgree, EnvironmentThroughPortals) {
    if (!HasOctree()) GTEST_SKIP() << "Only the octree finds portals.";
    for (const char *name : {"sunny-room", "blinds"}) {
        View view(BuildFile(fmt::format("{0}/scenes/{1}/{1}.pbrt", PBRT_SOURCE_DIR, name), Reduced(6)), 10, 8);
        const std::vector<std::string> labels = {"bvh", "octree:portals=always", "octree:portals=never", "octree"};
        auto good = ExpectAgreement(name, view, labels);
        ExpectNoticed(name, "octree, half of the portals 15 % off", view, good, "octree:portals=always",
                      [](const LightQuery &, const SampledLight &s) {
                          return s.region.portals && s.region.index % 2 == 0 ? s.pmf * Float(1.15) : s.pmf;
                      });
    }
}

TEST(LightSamplersAgree, VeachAjar) {
    std::string folder = RealScenes();
    if (folder.empty()) GTEST_SKIP() << "*** Veach-Ajar not found: not compared ***";
    View view(BuildFile(folder + "veach-ajar/veach-ajar.pbrt", Reduced(12)), 16, 8);
    ExpectAgreement("veach-ajar", view, LabelsThatDependOnThePlace());
}

/// A closed box of emitting diffuse walls: radiance L (1 + r + ... + r^depth) everywhere, whatever light is chosen.
TEST(LightSamplersAgree, FurnaceHasTheAnalyticRadiance) {
    const std::string corners = "-1 -1 -1  1 -1 -1  1 1 -1  -1 1 -1  -1 -1 1  1 -1 1  1 1 1  -1 1 1";
    const std::string text = SceneText()
                                 .LookAt("0.2 0.1 -0.5  0 0 1  0 1 0")
                                 .Camera(90)
                                 .Film(32, 32)
                                 .Filter("box")
                                 .Integrator("path", 4)
                                 .World(Objects()
                                            .Material("diffuse", "'spectrum reflectance' [ 300 0.5 900 0.5 ]")
                                            .AreaLight("1 1 1", "'bool twosided' true")
                                            .Triangles(corners, "0 1 2 0 2 3  4 6 5 4 7 6")
                                            .Triangles(corners, "0 5 1 0 4 5  1 6 2 1 5 6")
                                            .Triangles(corners, "2 7 3 2 6 7  3 4 0 3 7 4"));
    View view(BuildText(text), 4, 6);
    std::vector<std::string> labels = Labels();
    // Everything is visible from everywhere: fewer voxels suffice.
    std::ranges::replace(labels, std::string("neepp"), std::string("neepp:voxels=8"));
    constexpr double kExpected = 1 + 0.5 + 0.25 + 0.125 + 0.0625;
    for (const std::string &label : labels) {
        PixelStatistics s = view.Render(label, 7);
        Agreement a;
        a.level = SidakAlpha(kAlpha, 3 * labels.size());
        for (int c = 0; c < 3; ++c) {
            const PixelStatistics::Mean m = s.Of(Bounds2i({0, 0}, s.Resolution()), c);
            const double error = std::sqrt(m.variance);
            // The RGB to spectrum table is exact to a thousandth.
            const double off = std::max(0.0, std::abs(m.value - kExpected) - 1e-3 * kExpected);
            a.worstP = std::min(a.worstP, StudentTail(off / error, m.dof));
            EXPECT_LT(error, 0.005 * kExpected) << "too noisy to compare";
            if (c != 1) continue;
            a.difference = m.value / kExpected - 1;
            a.error = error / kExpected;
        }
        AddRow("furnace", label, a, a.Agrees() ? "agrees" : "DISAGREES");
        EXPECT_TRUE(a.Agrees()) << label;
    }
}

TEST(LightSamplersAgree, OneThreadAndThreeGiveTheSameBits) {
    for (const std::string &label : Labels()) {
        RenderRequest request;
        request.file = std::string(PBRT_SOURCE_DIR) + "/tests/render/scenes/slit.pbrt";
        request.build = Reduced(4);
        request.build.samplesPerPixel = 4;
        request.build.lightSampler = label.substr(0, label.find('+'));
        request.build.meshLights = label.find('+') != std::string::npos;
        const auto render = [&] { return RenderScene(request).image; };
        EXPECT_TRUE(SameBits(OnThreads(1, render), OnThreads(3, render))) << label;
    }
}

}  // namespace
}  // namespace pbrt::test
