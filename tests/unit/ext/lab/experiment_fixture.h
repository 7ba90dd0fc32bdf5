#pragma once
#include <gtest/gtest.h>

#include <atomic>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "ext/lab/experiment.h"
#include "support/errors.h"
#include "support/folder_test.h"
#include "support/scene_text.h"

namespace ext::lab {

namespace fs = std::filesystem;
using pbrt::test::Objects, pbrt::test::SceneText, pbrt::test::ExpectError;

/// A view of 32 x 24 pixels.
std::string ViewOf(const std::string &objects);
/// Three point lights of similar strength over a floor.
std::string ThreeLights();

Json ReadJson(const fs::path &path);
/// Expects that both files have pixels of equal bits.
void ExpectSamePixels(const fs::path &a, const fs::path &b);

inline const Json &SamplerOf(const ExperimentOutcome &o, size_t i) { return o.results.at("samplers").at(i); }
inline const Json &SummaryOf(const ExperimentOutcome &o, size_t i) { return SamplerOf(o, i).at("summary"); }

/// Shared by the samplers that a registry makes; the experiment is cancelled when `callsLeft` reaches 0.
struct Switch {
    std::atomic<int64_t> callsLeft{1 << 30};
    Progress *progress = nullptr;
};

/// Experiments on three point lights over a floor, in a folder of their own.
class Experiment : public pbrt::test::FolderTest {
  protected:
    Experiment();
    ~Experiment() override;
    void AddSampler(const std::string &name, size_t blind, LightSamplerTraits traits = {});
    ExperimentSettings Settings(const std::string &out, const std::vector<std::string> &samplers);
    /// Nothing if the experiment is cancelled.
    std::optional<ExperimentOutcome> TryToRun(const ExperimentSettings &settings);
    ExperimentOutcome Run(const ExperimentSettings &settings) { return TryToRun(settings).value(); }
    void ExpectSamePictures(const std::string &a, const std::string &b, const std::vector<std::string> &samplers,
                            int seeds);
    std::vector<fs::path> ReferencesIn(const std::string &folder) const;

    PluginRegistry registry_;
    std::shared_ptr<Switch> switch_ = std::make_shared<Switch>();
};

}  // namespace ext::lab
