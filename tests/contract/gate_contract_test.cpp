// The contract of shadow-ray gates, over every registered gate and every scene.
#include <gtest/gtest.h>

#include <map>

#include "pbrt/build/light_sampler_spec.h"
#include "pbrt/core/parallel.h"
#include "pbrt/integrators/path_integrator.h"
#include "pbrt/integrators/render_loop.h"
#include "pbrt/math/rng.h"
#include "render/agreement_statistics.h"
#include "scene_fixtures.h"

namespace pbrt::test {
namespace {

/// Every registered gate, also with other parameters where these change how the gate works.
std::vector<std::string> GateLabels() {
    std::vector<std::string> labels;
    for (const std::string &name : AllSamplers().gates.Names()) {
        labels.push_back(name);
        if (name == "neepp") labels.push_back("neepp:voxels=4,samples=1,minimum=0.02");
    }
    return labels;
}

std::unique_ptr<ShadowRayGate> MakeGate(const std::string &label, const SceneFixture &fixture) {
    ShadowGateSpec spec = ReadLightSelection("uniform+gate=" + label, AllSamplers()).gate;
    return spec.entry->make(spec.params, fixture.Lights());
}
std::unique_ptr<ShadowRayGate> MakePrepared(const std::string &label, const SceneFixture &fixture) {
    std::unique_ptr<ShadowRayGate> gate = MakeGate(label, fixture);
    fixture.Prepare(*gate);
    return gate;
}

/// A shadow segment that a path would ask the gate about.
struct Segment {
    size_t query;
    LightId light;
    Point3 onLight;
};
std::vector<Segment> Segments(const SceneFixture &fixture) {
    SampledWavelengths lambda = SampledWavelengths::SampleVisible(0.5f);
    std::vector<Segment> segments;
    Rng rng(4);
    size_t step = fixture.Lights().Size() / 300 + 1;
    for (size_t q = 0; q < fixture.queries.size(); ++q)
        for (size_t l = q % step; l < fixture.Lights().Size(); l += step)
            for (int k = 0; k < 4; ++k) {
                LightSampleContext from;
                from.p = fixture.queries[q].p;
                from.n = fixture.queries[q].n;
                from.ns = fixture.queries[q].ns;
                if (auto s = fixture.Lights()[LightId(l)].SampleLi(from, rng.Uniform2(), lambda, true))
                    segments.push_back({q, LightId(l), s->pLight});
            }
    return segments;
}

using Names = std::tuple<std::string, std::string>;  // fixture, gate

class GateContract : public testing::TestWithParam<Names> {
  protected:
    const SceneFixture &Fixture() const { return SceneFixtureOf(std::get<0>(GetParam())); }
    const std::string &Label() const { return std::get<1>(GetParam()); }
    Float Ask(const ShadowRayGate &gate, const Segment &s) const {
        return gate.TraceProbability(Fixture().queries[s.query], s.light, s.onLight);
    }
    void ExpectProbabilities(const ShadowRayGate &gate) const {
        for (const Segment &s : Segments(Fixture())) {
            Float p = Ask(gate, s);
            ASSERT_GT(p, 0) << "query " << s.query << " light " << s.light.value;
            ASSERT_LE(p, 1) << "query " << s.query << " light " << s.light.value;
        }
    }
};

TEST_P(GateContract, TraceProbabilityIsAboveZeroAndAtMostOne) {
    ExpectProbabilities(*MakePrepared(Label(), Fixture()));
    ExpectProbabilities(*MakeGate(Label(), Fixture()));  // Prepare was not called
}

TEST_P(GateContract, SameAnswerEveryTimeAndFromAnyThread) {
    std::unique_ptr<ShadowRayGate> gate = MakePrepared(Label(), Fixture());
    std::vector<Segment> segments = Segments(Fixture());
    auto n = static_cast<int64_t>(segments.size());
    std::vector<Float> parallel(segments.size()), serial;
    ThreadLimit limit(4);
    ParallelFor(n, 1, [&](int64_t begin, int64_t end) {
        for (int64_t i = begin; i < end; ++i)
            parallel[static_cast<size_t>(i)] = Ask(*gate, segments[static_cast<size_t>(i)]);
    });
    for (const Segment &s : segments) serial.push_back(Ask(*gate, s));
    EXPECT_EQ(parallel, serial);
}

TEST_P(GateContract, PreparedTheSameByOneThreadAndByThree) {
    std::unique_ptr<ShadowRayGate> one, three;
    {
        ThreadLimit limit(1);
        one = MakePrepared(Label(), Fixture());
    }
    {
        ThreadLimit limit(3);
        three = MakePrepared(Label(), Fixture());
    }
    std::vector<Segment> segments = Segments(Fixture());
    for (const Segment &s : segments) ASSERT_EQ(Ask(*one, s), Ask(*three, s));
    // The order of the questions does not matter either.
    std::unique_ptr<ShadowRayGate> backwards = MakePrepared(Label(), Fixture());
    for (size_t i = segments.size(); i-- > 0;) ASSERT_EQ(Ask(*backwards, segments[i]), Ask(*one, segments[i]));
}

Image Render(const SceneFixture &fixture, std::unique_ptr<ShadowRayGate> gate, int samplesPerPixel, int seed) {
    const BuiltScene &built = fixture.built;
    PathContext context{*built.scene, *built.camera, samplesPerPixel, true};
    PathSettings path;
    path.maxDepth = 2;
    const LightSamplerRegistry::Entry &uniform = AllSamplers().samplers.Find("uniform");
    PathIntegrator integrator(context, path, AllSamplers().Make(uniform, fixture.Lights(), ParamSet(), false),
                              std::move(gate));
    Progress progress;
    PrepareContext prepare = built.Preparation(progress);
    prepare.seed = seed;
    prepare.samplesPerPixel = samplesPerPixel;
    prepare.maxDepth = path.maxDepth;
    integrator.Prepare(prepare);
    DiagnosticSink sink;
    std::unique_ptr<Film> film = built.film->MakeRgbFilm();
    RenderSettings settings;
    settings.samplesPerPixel = samplesPerPixel;
    const std::unique_ptr<Sampler> sampler =
        Samplers().Make("independent", ParamSet(), SamplerContext{film->FullResolution(), samplesPerPixel, seed, sink});
    RenderWaves(integrator, *built.camera, *built.filter, *film, *sampler, settings, progress);
    return film->ToImage();
}

using GateMaker = std::function<std::unique_ptr<ShadowRayGate>()>;

PixelStatistics RenderMany(const SceneFixture &fixture, int firstSeed, const GateMaker &make) {
    PixelStatistics statistics;
    for (int run = 0; run < 5; ++run) statistics.Add(Render(fixture, make(), 16, firstSeed + run));
    return statistics;
}

/// Compares the means of tiles and of the whole image with renders without a gate, through the integrator.
Agreement AgainstNoGate(const std::string &fixtureName, const GateMaker &make) {
    static std::map<std::string, PixelStatistics> without;
    const SceneFixture &fixture = SceneFixtureOf(fixtureName);
    auto it = without.find(fixtureName);
    if (it == without.end()) it = without.emplace(fixtureName, RenderMany(fixture, 1000, [] { return nullptr; })).first;
    return Compare(RenderMany(fixture, 2000, make), {&it->second}, 1, 1e-5);
}

TEST_P(GateContract, MeanWithTheGateIsTheMeanWithout) {
    Agreement a = AgainstNoGate(std::get<0>(GetParam()), [&] { return MakeGate(Label(), Fixture()); });
    EXPECT_TRUE(a.Agrees()) << "p " << a.worstP << " at " << a.worst << "; level " << a.level;
}

/// Gives the same probability everywhere; a probability above 1 breaks the contract.
class LyingGate final : public ShadowRayGate {
  public:
    explicit LyingGate(Float said) : said_(said) {}
    Float TraceProbability(const LightQuery &, LightId, const Point3 &) const override { return said_; }

  private:
    Float said_;
};

TEST(GateContractPower, AGateThatIsTwoPercentOffIsNoticed) {
    // With a probability above 1 every ray is traced, but the light is divided by that probability.
    Agreement a = AgainstNoGate("OnePoint", [] { return std::make_unique<LyingGate>(Float(1.02)); });
    EXPECT_FALSE(a.Agrees()) << a.worstP;
    EXPECT_TRUE(AgainstNoGate("OnePoint", [] { return std::make_unique<LyingGate>(Float(0.5)); }).Agrees());
}

TEST(GateContractPower, EveryRegisteredGateIsTested) {
    EXPECT_GE(GateLabels().size(), AllSamplers().gates.Names().size());
}

std::string Identifier(std::string s) {
    std::replace_if(
        s.begin(), s.end(), [](char c) { return !std::isalnum(static_cast<unsigned char>(c)); }, '_');
    return s;
}

GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(GateContract);  // without src/ext there is no gate
INSTANTIATE_TEST_SUITE_P(Scenes, GateContract,
                         testing::Combine(testing::ValuesIn(SceneFixtureNames()), testing::ValuesIn(GateLabels())),
                         [](const auto &c) { return std::get<0>(c.param) + "_" + Identifier(std::get<1>(c.param)); });

}  // namespace
}  // namespace pbrt::test
