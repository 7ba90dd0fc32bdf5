#include "experiment_fixture.h"

#include <cstring>
#include <fstream>

#include "pbrt/core/log.h"
#include "pbrt/images/image.h"

void register_guide(pbrt::PluginRegistry &registry);  // of ext/guiding

namespace ext::lab {

std::string ViewOf(const std::string &objects) {
    return SceneText()
        .LookAt("0 3 -6  0 0 0  0 1 0")
        .Camera(40)
        .Film(32, 24, "'string filename' 'scene.exr'")
        .Samples(4)
        .Integrator("path", 2)
        .World(objects);
}

std::string ThreeLights() {
    return ViewOf(Objects()
                      .PointLight("-2 2 0", "4 4 4")
                      .PointLight("0 2 1", "3 3 4")
                      .PointLight("2 2 0", "4 4 3")
                      .Diffuse("0.6 0.4 0.3")
                      .Sphere(0.7)
                      .Quad("-4 -1 -4  4 -1 -4  -4 -1 4  4 -1 4"));
}

namespace {

/// Uniform over all lights but the last `blind` ones. Cancels the experiment after a number of calls.
class TestSampler final : public LightSampler {
  public:
    TestSampler(size_t lights, size_t blind, std::shared_ptr<Switch> interrupt)
        : seen_(lights - blind), interrupt_(std::move(interrupt)) {}
    std::optional<SampledLight> Choose(const LightQuery &, const void *, Float u, Point2 *) const override {
        if (--interrupt_->callsLeft == 0) interrupt_->progress->Cancel();
        auto i = std::min(size_t(u * Float(seen_)), seen_ - 1);
        return SampledLight{LightId(i), 1 / Float(seen_)};
    }
    Float Probability(const LightQuery &, const void *, LightId light) const override {
        return light.value < seen_ ? 1 / Float(seen_) : 0;
    }
    void Report(Json &report) const override { report["leaves"] = 7; }
    void Inspect(const LightQuery &query, std::vector<InspectedValue> &values) const override {
        values.push_back({"side", query.p.x > 0 ? 1.0 : 2.0, true});
    }
    std::string DescribeStructure() const override { return "nothing learned"; }

  private:
    size_t seen_;
    std::shared_ptr<Switch> interrupt_;
};

}  // namespace

Json ReadJson(const fs::path &path) {
    std::ifstream in(path);
    return Json::parse(in);
}

void ExpectSamePixels(const fs::path &a, const fs::path &b) {
    const Image one = ReadImage(a.string()).image, two = ReadImage(b.string()).image;
    ASSERT_EQ(one.Bytes(), two.Bytes());
    ASSERT_GT(one.Bytes(), 0u);
    EXPECT_EQ(std::memcmp(one.Data(), two.Data(), one.Bytes()), 0) << a << " " << b;
}

Experiment::Experiment() {
    SetLogLevel(LogLevel::Error);
    Write("scene.pbrt", ThreeLights());
    RegisterStockLightSamplers(registry_);
    register_guide(registry_);
    AddSampler("honest", 0);
    AddSampler("blind", 1);
}

Experiment::~Experiment() { SetLogLevel(LogLevel::Info); }

void Experiment::AddSampler(const std::string &name, size_t blind, LightSamplerTraits traits) {
    auto make = [blind, interrupt = switch_](NoParams, const ParamSet &, const LightGroups &groups) {
        return std::make_unique<TestSampler>(groups.LightCount(), blind, interrupt);
    };
    registry_.samplers.Add<NoParams>(name, "of the test", make, traits);
}

ExperimentSettings Experiment::Settings(const std::string &out, const std::vector<std::string> &samplers) {
    ExperimentSettings s;
    s.scene = Path("scene.pbrt");
    s.samplers = ParseSamplerChoices(samplers, registry_);
    s.samplesPerPixel = 4;
    s.seeds = 2;
    s.referenceSamples = 32;
    s.selectionWork = 1e5;
    s.outFolder = Path(out);
    s.cacheFolder = Path("cache");
    return s;
}

std::optional<ExperimentOutcome> Experiment::TryToRun(const ExperimentSettings &settings) {
    Progress progress;
    switch_->progress = &progress;
    return RunExperiment(settings, registry_, progress, nullptr);
}

void Experiment::ExpectSamePictures(const std::string &a, const std::string &b,
                                    const std::vector<std::string> &samplers, int seeds) {
    for (const std::string &sampler : samplers)
        for (int seed = 0; seed < seeds; ++seed) {
            const std::string name = SafeFileName(sampler) + "/seed" + std::to_string(seed) + ".exr";
            ExpectSamePixels(folder_ / a / name, folder_ / b / name);
        }
    ExpectSamePixels(folder_ / a / "reference-0.exr", folder_ / b / "reference-0.exr");
}

std::vector<fs::path> Experiment::ReferencesIn(const std::string &folder) const {
    std::vector<fs::path> found;
    for (const auto &entry : fs::directory_iterator(folder_ / folder))
        if (entry.path().filename().string().starts_with("scene.reference-")) found.push_back(entry.path());
    std::sort(found.begin(), found.end());
    return found;
}

}  // namespace ext::lab
