#pragma once
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "pbrt/core/progress.h"
#include "pbrt/lab/campaign_settings.h"

namespace pbrt::lab {

struct CampaignOutcome {
    nlohmann::ordered_json results;  ///< what results.json holds
    std::string text;                ///< the table for people
};

/// Compares light samplers on one scene: reads and builds it once, makes the reference, renders every (sampler, seed)
/// in rounds A B C A B C ..., measures after each, and writes results, pictures and tables into the output folder.
/// Takes up what the folder holds of an interrupted campaign with the same settings. Nothing: cancelled; what was
/// finished stays. Throws UserError, about the settings before anything is rendered. `display` may be null.
std::optional<CampaignOutcome> RunCampaign(const CampaignSettings &settings, const LightSamplerRegistry &registry,
                                           Progress &cancel, ProgressSink *display);

/// Where runs stop to be measured. By time: one sample, then budget / 64, / 32, ..., / 1 of every run's own clock. By
/// samples: 1, 2, 4, ... and all.
struct Checkpoint {
    int samples = 0;
    double seconds = 0;
};
std::vector<Checkpoint> Checkpoints(const CampaignSettings &settings);

}  // namespace pbrt::lab
