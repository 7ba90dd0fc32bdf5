#pragma once
#include <optional>

#include "ext/lab/experiment_display.h"
#include "ext/lab/lab_scene.h"
#include "ext/lab/run_record.h"

namespace ext::lab {

/// Candidate sampler for a reference, with variance and cost estimated from a few samples.
struct PilotEntry {
    SamplerChoice choice;
    /// Variance of one sample per pixel, relative to the squared local brightness (8x8 tiles of the other candidates).
    /// Maximum of two estimates: from the candidate's own two images, and from its difference to the others.
    double variance = 0;
    double secondsPerSample = 0;  ///< per pixel sample, for the whole image
};

/// Ranks the experiment's samplers (except oracles) and stock's bvh and uniform over single lights by variance per
/// sample. Stores the result in `records`. Returns nothing if cancelled.
std::optional<std::vector<PilotEntry>> RunPilot(const ExperimentSettings &settings, const LabScene &scene,
                                                const PluginRegistry &registry, const RecordFolder &records,
                                                Progress &cancel, ExperimentDisplay &display);

double MeanSecondsPerSample(const std::vector<PilotEntry> &entries);
/// Estimates the seconds of all runs of the experiment; samplers without entry have average cost.
double EstimateRuns(const ExperimentSettings &settings, const std::vector<PilotEntry> &entries);

/// True for samplers of stock pbrt, whose images are considered unbiased.
bool IsTrusted(const SamplerChoice &choice);

}  // namespace ext::lab
