#pragma once
#include <optional>

#include "pbrt/lab/campaign_display.h"
#include "pbrt/lab/lab_scene.h"
#include "pbrt/lab/run_record.h"

namespace pbrt::lab {

/// A sampler that could make a reference, and what a few samples tell of it.
struct PilotEntry {
    SamplerChoice choice;
    /// Of one sample per pixel, relative to the brightness around (other candidates' 8x8 tiles): by the candidate's own
    /// pictures, or by what they lack against the others' if that is more.
    double variance = 0;
    double secondsPerSample = 0;  ///< per pixel, of the whole picture
};

/// Ranks the samplers of the campaign (oracles left out) and stock's bvh and uniform over single lights: least variance
/// per sample first. Remembers its result in `records`. Nothing: cancelled.
std::optional<std::vector<PilotEntry>> RunPilot(const CampaignSettings &settings, const LabScene &scene,
                                                const LightSamplerRegistry &registry, const RecordFolder &records,
                                                Progress &cancel, CampaignDisplay &display);

double MeanSecondsPerSample(const std::vector<PilotEntry> &entries);
/// Seconds that all runs of the campaign will take; a sampler without an entry counts as one of average cost.
double EstimateRuns(const CampaignSettings &settings, const std::vector<PilotEntry> &entries);

/// Stock samplers without a gate: their pictures are right by contract, whatever a plug-in does.
bool IsTrusted(const SamplerChoice &choice, const LabScene &scene);

}  // namespace pbrt::lab
