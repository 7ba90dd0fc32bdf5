#pragma once
#include <optional>
#include <string>

#include "ext/lab/experiment_settings.h"
#include "ext/lab/reference.h"
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

/// Returns where the picture of a run is measured. With a time budget: after one sample, then at budget / 64, / 32,
/// ..., / 1 of the run's own clock. Else after 1, 2, 4, ... and all samples.
std::vector<RenderTarget> Checkpoints(const ExperimentSettings &settings);

/// Writes inspection views of a sampler of the experiment at the first visible surfaces, as
/// <sampler>/views/*.png. For sampler 0 it also writes those that are the same for every sampler, as views/*.png. Takes
/// some seconds. Returns what was written; null: cancelled.
Json WriteViews(const ExperimentSettings &settings, const LabScene &scene, size_t sampler, const Integrator &integrator,
                Progress &cancel);

/// The name of the note in the records that keeps what WriteViews returned.
std::string ViewsNote(const SamplerChoice &choice);
/// Returns true if all pictures of the note exist with its file sizes.
bool ViewsAreWhole(const ExperimentSettings &settings, const Json &note);

/// Adds "views" to results.json, for the scene and for every sampler whose views were written.
void AddViews(const ExperimentSettings &settings, const RecordFolder &records, Json *results);

/// Writes references, results and errors as pictures, and adds them and the crops to `json`.
void WritePictures(const ExperimentSettings &settings, const LabScene &scene, const References &references,
                   const std::vector<std::vector<Image>> &pictures, Json *json);

}  // namespace ext::lab
