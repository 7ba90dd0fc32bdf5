#pragma once
#include <optional>
#include <string>

#include "ext/lab/experiment_settings.h"
#include "ext/lab/text_output.h"
#include "pbrt/core/progress.h"

namespace ext::lab {

struct ExperimentOutcome {
    Json results;      ///< the contents of results.json
    std::string text;  ///< the table and the conclusion, for the terminal
};

/// Compares light samplers on one scene: reads and builds it once, makes the reference, renders every (sampler, seed)
/// in rounds A B C A B C ..., measures after each, and writes results, pictures and tables into the output folder.
/// Continues an interrupted experiment of the same settings from the records in the folder. Returns nothing if
/// cancelled; the records of finished rounds stay. Throws UserError; errors in the settings are found before anything
/// is rendered. `display` may be null.
std::optional<ExperimentOutcome> RunExperiment(const ExperimentSettings &settings, const PluginRegistry &registry,
                                               Progress &cancel, ProgressSink *display);

/// Where the picture of a run is measured: after so many samples, or at a time of the run's own clock. With a time
/// budget: after one sample, then at budget / 64, / 32, ..., / 1. Else after 1, 2, 4, ... and all samples.
struct Checkpoint {
    int samples = 0;
    double seconds = 0;
};
std::vector<Checkpoint> Checkpoints(const ExperimentSettings &settings);

}  // namespace ext::lab
