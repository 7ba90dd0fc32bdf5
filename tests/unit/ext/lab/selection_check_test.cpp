#include "ext/lab/selection_check.h"

#include <gtest/gtest.h>

#include <cmath>

#include "pbrt/lightsamplers/simple_light_samplers.h"
#include "pbrt/math/rng.h"
#include "support/build_text.h"
#include "support/render_scene.h"
#include "support/scene_text.h"
#include "support/statistics.h"
#include "support/threads.h"

namespace ext::lab {
namespace {

using test::Objects, test::RunningStatistics, test::SceneText;

/// A floor with a wall, a mirror ball and a glossy ball, under three point lights and a lamp of two triangles.
std::string SelectionScene(const std::string &media = "", const std::string &integrator = "path") {
    const Objects ball = Objects().Sphere(0.5);
    return SceneText()
        .LookAt("0 -6 4  0 0 0.5  0 0 1")
        .Head(media)
        .Camera(45)
        .Film(32, 32)
        .Integrator(integrator, 3)
        .World(Objects()
                   .PointLight("-2 0 2", "4 4 4")
                   .PointLight("2 0 2", "3 3 4")
                   .PointLight("0 2 3", "1 .5 .2")
                   .Attribute("", Objects().AreaLight("3 3 3").Triangles("-1 -1 3  -1 1 3  1 1 3  1 -1 3"))
                   .Diffuse(".5 .5 .5")
                   .Quad("-4 -4 0  4 -4 0  -4 4 0  4 4 0")
                   .Quad("0 -1 0  0 4 0  0 -1 1.5  0 4 1.5")
                   .Attribute("Material 'conductor' 'float roughness' 0 Translate 1 -1 0.5", ball)
                   .Attribute("Material 'conductor' 'float roughness' 0.2 Translate -1 -1 0.5", ball));
}

/// Uniform over the lights, except for the defect that a test sets.
class Spoilt final : public LightSampler {
  public:
    explicit Spoilt(size_t lights) : count_(lights) {}
    std::optional<SampledLight> Choose(const LightQuery &q, const void *, Float u, Point2 *) const override {
        auto i = std::min(size_t(u * Float(count_)), count_ - 1);
        if (blindTo && i == *blindTo && where(q)) return {};
        // An eighth of the samples of light 0 returns light 1, without any change of the probabilities.
        if (takesElsewhere && i == 0 && u * Float(count_) < 0.125f) i = 1;
        return SampledLight{LightId(i), 1 / Float(count_) * (i == 0 ? claims : 1)};
    }
    Float Probability(const LightQuery &q, const void *, LightId light) const override {
        if (blindTo && light.value == *blindTo && where(q)) return 0;
        return 1 / Float(count_) * pmfSays;
    }
    std::optional<size_t> blindTo;
    std::function<bool(const LightQuery &)> where = [](const LightQuery &) { return true; };
    bool takesElsewhere = false;
    Float claims = 1, pmfSays = 1;

  private:
    size_t count_;
};

class SelectionCheck : public testing::Test {
  protected:
    explicit SelectionCheck(const std::string &text = SelectionScene())
        : built_(test::BuildText(text)), spoilt_(built_.scene->Lights().Size()) {}
    SelectionReport Check(const LightSampler &lights) {
        Progress progress;
        return *CheckSelection(SelectionVertices::Measure(built_, 0, progress), lights, settings_, progress);
    }
    /// The indices of all delta lights, or of all others.
    std::vector<size_t> LightsOf(bool delta) const {
        std::vector<size_t> list;
        for (size_t l = 0; l < built_.scene->Lights().Size(); ++l)
            if (IsDelta(built_.scene->Lights()[LightId(l)].Kind()) == delta) list.push_back(l);
        return list;
    }
    BuiltScene built_;
    Spoilt spoilt_;
    SelectionSettings settings_;
};

TEST_F(SelectionCheck, HonestSamplersAreClean) {
    const SelectionReport own = Check(spoilt_);
    EXPECT_EQ(own.verdict, BiasVerdict::Clean) << own.text;
    EXPECT_GT(own.vertices, 1000);
    EXPECT_LE(own.visibleSixteenth, settings_.bias.interest);
    EXPECT_LT(own.visibleImage, own.visibleSixteenth);
    const SelectionReport power = Check(PowerLightSampler(built_.scene->Lights().ByComponent()));
    EXPECT_EQ(power.verdict, BiasVerdict::Clean) << power.text;
}

TEST_F(SelectionCheck, ALightThatIsNeverChosenIsMissed) {
    spoilt_.blindTo = LightsOf(true).back();
    EXPECT_EQ(Check(spoilt_).verdict, BiasVerdict::Biased);
    EXPECT_LT(Check(spoilt_).difference, -0.005);
}

TEST_F(SelectionCheck, AlsoIfItIsMissedInACornerOnly) {
    spoilt_.blindTo = LightsOf(true).front();
    spoilt_.where = [](const LightQuery &q) { return q.p.x < -1 && q.p.y > 1.5f; };
    const SelectionReport report = Check(spoilt_);
    EXPECT_EQ(report.verdict, BiasVerdict::Biased) << report.text;
    EXPECT_GE(report.worstRegion, 0) << report.text;
    EXPECT_LT(report.worstDifference, -0.05);
}

TEST_F(SelectionCheck, ALightThatBsdfSamplingReachesIsNotLost) {
    // The integrator gives a BSDF sample the MIS weight 1 where the PMF of the light is 0.
    spoilt_.blindTo = LightsOf(false).front();
    EXPECT_EQ(Check(spoilt_).verdict, BiasVerdict::Clean) << Check(spoilt_).text;
}

TEST_F(SelectionCheck, ProbabilitiesThatDoNotAgreeAreDetected) {
    spoilt_.claims = 1.2f;
    EXPECT_EQ(Check(spoilt_).verdict, BiasVerdict::Biased) << Check(spoilt_).text;
    spoilt_.claims = 1;
    spoilt_.takesElsewhere = true;
    EXPECT_EQ(Check(spoilt_).verdict, BiasVerdict::Biased) << Check(spoilt_).text;
    spoilt_.takesElsewhere = false;
    // The probability that Sample returns is right, but BSDF samples that hit the lamp are weighted by another one.
    spoilt_.pmfSays = 0.5f;
    EXPECT_EQ(Check(spoilt_).verdict, BiasVerdict::Biased) << Check(spoilt_).text;
}

TEST_F(SelectionCheck, ThreadsDoNotMatter) {
    const auto text = [&] { return ToJson(Check(spoilt_)).dump(); };
    EXPECT_EQ(test::OnThreads(1, text), test::OnThreads(2, text));
}

TEST_F(SelectionCheck, JsonKeepsWhatIsReported) {
    const SelectionReport report = Check(spoilt_);
    EXPECT_EQ(ToJson(SelectionFromJson(ToJson(report))), ToJson(report));
    SelectionReport nothing;
    nothing.visibleImage = nothing.visibleSixteenth = std::numeric_limits<double>::infinity();
    EXPECT_EQ(ToJson(SelectionFromJson(ToJson(nothing))), ToJson(nothing));
}

TEST_F(SelectionCheck, BothChecksTogether) {
    auto together = [](BiasVerdict pictures, BiasVerdict vertices) {
        BiasReport report;
        report.verdict = pictures;
        SelectionReport selection;
        selection.verdict = vertices;
        AddSelection(selection, &report);
        return report.verdict;
    };
    using enum BiasVerdict;
    EXPECT_EQ(together(Unknown, Clean), Clean);
    EXPECT_EQ(together(Unknown, Unknown), Unknown);
    EXPECT_EQ(together(Clean, Unknown), Clean);
    EXPECT_EQ(together(Clean, Biased), Biased);
    EXPECT_EQ(together(Biased, Clean), Biased);
}

TEST_F(SelectionCheck, ImagesWithoutAStatementAreNamedLikeInTheirOwnCheck) {
    BiasReport report;
    report.visibleImage = 4210.5;
    report.visibleSixteenth = std::numeric_limits<double>::infinity();
    SelectionReport selection;
    selection.verdict = BiasVerdict::Clean;
    AddSelection(selection, &report);
    EXPECT_NE(report.text.find("alone: more than 1000 % in the whole image, none in regions"), std::string::npos)
        << report.text;
}

/// The same scene full of fog, in which most of the first vertices lie.
class SelectionCheckInFog : public SelectionCheck {
  protected:
    SelectionCheckInFog()
        : SelectionCheck(
              SelectionScene("MakeNamedMedium 'fog' 'string type' 'homogeneous' 'rgb sigma_s' [ .15 .12 .1 ] "
                             "'rgb sigma_a' [ .01 .02 .03 ] 'float g' .4 MediumInterface '' 'fog'",
                             "volpath")) {}
    static bool IsInFog(const LightQuery &q) { return q.ns == Normal3(0); }
    static bool IsOnSurface(const LightQuery &q) { return !IsInFog(q); }
};

TEST_F(SelectionCheckInFog, VerticesInMediaAreChecked) {
    Progress progress;
    const SelectionVertices vertices = SelectionVertices::Measure(built_, 0, progress);
    size_t inFog = 0, onSurfaces = 0;
    for (size_t r = 0; r < vertices.RegionCount(); ++r)
        for (const SelectionVertices::Vertex &v : vertices.OfRegion(r)) {
            ++(v.IsInMedium() ? inFog : onSurfaces);
            const LightQuery query = v.FullQuery();
            EXPECT_EQ(query.phase ? &v.phase : nullptr, query.phase);
            EXPECT_NE(query.phase == nullptr, query.bsdf == nullptr);
            EXPECT_EQ(query.phase != nullptr, v.IsInMedium());
        }
    EXPECT_GT(inFog, 1000u);
    EXPECT_GT(onSurfaces, 1000u);
    EXPECT_EQ(Check(spoilt_).verdict, BiasVerdict::Clean) << Check(spoilt_).text;
}

TEST_F(SelectionCheckInFog, ALightThatIsLostInTheFogOnlyIsMissed) {
    spoilt_.blindTo = LightsOf(true).front();
    for (auto where : {IsInFog, IsOnSurface}) {
        spoilt_.where = where;
        EXPECT_EQ(Check(spoilt_).verdict, BiasVerdict::Biased) << Check(spoilt_).text;
        EXPECT_LT(Check(spoilt_).difference, -0.005);
    }
}

/// A wall in a ball of fog, in which light is scattered more than once. The lights are far away, so that no place is so
/// close to one that chance decides.
std::string WallInFog(const std::string &scattering) {
    return SceneText()
        .LookAt("0 -12 1  0 0 0  0 0 1")
        .Camera(40)
        .Film(8, 8, "'bool savefp16' false")
        .Filter("box")
        .Samples(4096)
        .Integrator("volpath", 16)
        .World(Objects()
                   .Light("distant", "'point3 from' [ -2 -3 3 ] 'rgb L' [ 4 4 4 ]")
                   .Light("distant", "'point3 from' [ 3 -1 0 ] 'rgb L' [ 3 3 3 ]")
                   .Add("MakeNamedMedium 'fog' 'string type' 'homogeneous' 'rgb sigma_a' [ .03 .03 .03 ] 'float g' .4 "
                        "'rgb sigma_s' " +
                        scattering)
                   .Attribute("MediumInterface 'fog' '' Material 'interface'", Objects().Sphere(4))
                   .Add("MediumInterface 'fog' 'fog'")
                   .Diffuse(".5 .5 .5")
                   .Quad("-2 1 -2  2 1 -2  -2 1 2  2 1 2"));
}

RunningStatistics Picture(const std::string &text) { return test::ChannelStatistics(test::RenderText(text).image); }

/// The light that is measured at all vertices of a path, which is what the path brings to the picture: there are no
/// lights that scattering could find.
RunningStatistics Measured(const std::string &text) {
    const BuiltScene built = test::BuildText(text);
    Progress progress;
    RunningStatistics s;
    for (int seed = 0; seed < 24; ++seed) {
        const SelectionVertices vertices = SelectionVertices::Measure(built, seed, progress);
        double light = 0;
        for (size_t r = 0; r < vertices.RegionCount(); ++r)
            for (const auto &v : vertices.OfRegion(r))
                for (const auto &m : v.lights) light += double(m.c);
        s.Add(light / (16. * vertices.PathsPerRegion()));
    }
    return s;
}

TEST(SelectionVerticesInFog, MeasureTheLightOfThePicture) {
    // The units differ, so the dense fog is compared with air.
    const std::string dense = WallInFog("[ .25 .25 .25 ]"), thin = WallInFog("[ 0 0 0 ]");
    const RunningStatistics a = Picture(dense), b = Picture(thin), c = Measured(dense), d = Measured(thin);
    const double picture = a.mean / b.mean, measured = c.mean / d.mean;
    const double error =
        std::sqrt(Sqr(c.StandardError() / c.mean) + Sqr(d.StandardError() / d.mean)) + 0.002;  // that of the pictures
    EXPECT_LT(std::abs(measured / picture - 1), 4 * error) << picture << " " << measured;
    EXPECT_LT(error, 0.012) << "too noisy to compare";
}

/// Sixteen regions of paths with two vertices. The light varies by factors of up to a thousand; a sample finds it
/// with `probability`.
std::vector<std::vector<VertexFinding>> Simulate(Rng &rng, int paths, double probability, double lost, int lostIn) {
    std::vector<std::vector<VertexFinding>> regions(16);
    for (int r = 0; r < 16; ++r)
        for (int i = 0; i < paths; ++i)
            for (int v = 0; v < 2; ++v) {
                VertexFinding f;
                f.light = std::exp(6.9f * rng.Uniform());
                double found = 0;
                constexpr int kDraws = 64;
                for (int d = 0; d < kDraws; ++d)
                    found += double(rng.Uniform()) < probability ? 1 / probability / kDraws : 0;
                if (r == lostIn) found *= 1 - lost;
                f.excess = f.light * float(found - 1);
                f.endsPath = v == 1;
                regions[size_t(r)].push_back(f);
            }
    return regions;
}

TEST(SelectionVerdict, FalseAlarmsAreRareAndBiasIsDetected) {
    Rng rng(5);
    int alarms = 0, seen = 0, tooMuch = 0;
    constexpr int kChecks = 400;
    for (int i = 0; i < kChecks; ++i) {
        // With the rarest samples that the check counts fully, one sample changes a vertex by a half.
        alarms += JudgeSelection(Simulate(rng, 256, 1. / 32, 0, -1), {}).verdict == BiasVerdict::Biased;
        if (i % 4 != 0) continue;
        const SelectionReport clean = JudgeSelection(Simulate(rng, 256, 1. / 4, 0, -1), {});
        seen +=
            JudgeSelection(Simulate(rng, 256, 1. / 4, clean.visibleSixteenth, 5), {}).verdict == BiasVerdict::Biased;
        tooMuch += JudgeSelection(Simulate(rng, 256, 1. / 4, clean.visibleSixteenth / 3, 5), {}).verdict ==
                   BiasVerdict::Biased;
    }
    EXPECT_LE(alarms, 7);  // 2 expected at the level of 0.5 %
    EXPECT_GE(seen, 80);   // of 100: the smallest visible bias is found in nine of ten checks
    EXPECT_LE(tooMuch, 20);
}

}  // namespace
}  // namespace ext::lab
