#pragma once
#include <optional>

#include "ext/lab/experiment_display.h"
#include "ext/lab/lab_scene.h"
#include "ext/lab/run_record.h"

namespace ext::lab {

/// A sampler that could make a reference, with its variance and cost as estimated from a few samples.
struct PilotEntry {
    SamplerChoice choice;
    /// Variance of one sample per pixel, relative to the squared brightness around it (8x8 tiles of the other
    /// candidates). The larger of two estimates: from the difference of the candidate's own two pictures, and from
    /// their difference to the pictures of the others.
    double variance = 0;
    double secondsPerSample = 0;  ///< per pixel, of the whole picture
};

/// Ranks the samplers of the experiment (oracles left out) and stock's bvh and uniform over single lights: least
/// variance per sample first. Keeps its result in `records`. Returns nothing if cancelled.
std::optional<std::vector<PilotEntry>> RunPilot(const ExperimentSettings &settings, const LabScene &scene,
                                                const PluginRegistry &registry, const RecordFolder &records,
                                                Progress &cancel, ExperimentDisplay &display);

double MeanSecondsPerSample(const std::vector<PilotEntry> &entries);
/// Estimates the seconds of all runs of the experiment; a sampler without an entry counts as one of average cost.
double EstimateRuns(const ExperimentSettings &settings, const std::vector<PilotEntry> &entries);

/// Returns true for the samplers of stock pbrt, whose pictures count as unbiased.
bool IsTrusted(const SamplerChoice &choice);

}  // namespace ext::lab
