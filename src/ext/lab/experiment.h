#pragma once
#include <optional>
#include <string>

#include "ext/lab/experiment_settings.h"
#include "ext/lab/reference.h"
#include "ext/lab/text_output.h"
#include "pbrt/core/progress.h"

namespace ext::lab {

struct ExperimentOutcome {
    Json results;      ///< contents of results.json
    std::string text;  ///< table and conclusion, for the terminal
};

/// Compares light samplers on one scene. Builds it once, creates the reference, and renders every (sampler, seed) in
/// rounds A B C A B C ..., measuring after each. Writes results, images and tables into the output folder. Resumes an
/// interrupted experiment of equal settings from the records in the folder. Returns nothing if cancelled; records of
/// finished rounds remain. Throws UserError; errors in the settings are reported before rendering. `display` may be
/// null.
std::optional<ExperimentOutcome> RunExperiment(const ExperimentSettings &settings, const PluginRegistry &registry,
                                               Progress &cancel, ProgressSink *display);

/// Measurement points of a run. With a time budget: after one sample, then at budget / 64, / 32, ..., / 1 of the run's
/// own clock. Else after 1, 2, 4, ... and all samples.
std::vector<RenderTarget> Checkpoints(const ExperimentSettings &settings);

/// Writes inspection views of a sampler at the first visible surfaces, as <sampler>/views/*.png; for sampler 0 also the
/// sampler-independent ones, as views/*.png. Takes some seconds. Returns what was written; null: cancelled.
Json WriteViews(const ExperimentSettings &settings, const LabScene &scene, size_t sampler, const Integrator &integrator,
                Progress &cancel);

/// Name of the record that stores the result of WriteViews.
std::string ViewsNote(const SamplerChoice &choice);
/// True if all images of the note exist with its file sizes.
bool ViewsAreWhole(const ExperimentSettings &settings, const Json &note);

/// Adds "views" to results.json, for the scene and every sampler with views.
void AddViews(const ExperimentSettings &settings, const RecordFolder &records, Json *results);

/// Writes references, results and errors as images, and adds them and the crops to `json`.
void WritePictures(const ExperimentSettings &settings, const LabScene &scene, const References &references,
                   const std::vector<std::vector<Image>> &pictures, Json *json);

}  // namespace ext::lab
