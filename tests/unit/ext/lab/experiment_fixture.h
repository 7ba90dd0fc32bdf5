#pragma once
#include <gtest/gtest.h>

#include <atomic>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "ext/lab/experiment.h"

namespace ext::lab {

namespace fs = std::filesystem;
/// Three point lights of similar strength over a floor.
extern const char *const kScene;

Json ReadJson(const fs::path &path);
/// Expects that both files have pixels of equal bits.
void ExpectSamePixels(const fs::path &a, const fs::path &b);

/// Shared by the samplers that a registry makes; the experiment is cancelled when `callsLeft` reaches 0.
struct Switch {
    std::atomic<int64_t> callsLeft{1 << 30};
    Progress *progress = nullptr;
};

/// Experiments on three point lights over a floor, in a folder of their own.
class Experiment : public ::testing::Test {
  protected:
    void SetUp() override;
    /// The scene with a part of its text replaced.
    void WriteScene(const std::string &part, const std::string &other);
    void TearDown() override;
    void AddSampler(const std::string &name, size_t blind);
    ExperimentSettings Settings(const std::string &out, const std::vector<std::string> &samplers);
    std::optional<ExperimentOutcome> Run(const ExperimentSettings &settings);
    std::string ErrorOf(const ExperimentSettings &settings);
    void ExpectSamePictures(const std::string &a, const std::string &b, const std::vector<std::string> &samplers,
                            int seeds);
    std::vector<fs::path> ReferencesIn(const std::string &folder) const;

    fs::path folder_;
    PluginRegistry registry_;
    std::shared_ptr<Switch> switch_ = std::make_shared<Switch>();
};

}  // namespace ext::lab
