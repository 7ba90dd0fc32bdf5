#pragma once
#include <optional>
#include <string>
#include <vector>

#include "ext/lab/experiment_settings.h"
#include "ext/lab/run_record.h"
#include "ext/lab/text_output.h"
#include "pbrt/core/progress.h"

namespace ext::lab {

struct ExperimentOutcome {
    Json results;      ///< contents of results.json
    std::string text;  ///< table and conclusion, for the terminal
};

/// Compares light samplers on one scene. Builds it once, creates the reference, and renders every (sampler, seed) in
/// rounds A B C A B C ..., measuring after each. Writes results, images and tables into the output folder. Resumes an
/// interrupted experiment of equal settings from the records in the folder. Returns nothing if cancelled; finished
/// rounds remain. Throws UserError, for errors in the settings before rendering. `display` may be null.
std::optional<ExperimentOutcome> RunExperiment(const ExperimentSettings &settings, const PluginRegistry &registry,
                                               Progress &cancel, ProgressSink *display);

/// Measurement points of a run. With a time budget: after one sample, then at budget / 64, / 32, ..., / 1 of the run's
/// own clock. Else after 1, 2, 4, ... and all samples.
std::vector<RenderTarget> Checkpoints(const ExperimentSettings &settings);

}  // namespace ext::lab
