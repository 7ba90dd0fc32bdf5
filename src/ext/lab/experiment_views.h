#pragma once
#include "ext/lab/lab_scene.h"
#include "ext/lab/run_record.h"

namespace ext::lab {

/// Writes inspection views of a sampler of the experiment at the first visible surfaces, as
/// <sampler>/views/*.png. For sampler 0 it also writes those that are the same for every sampler, as views/*.png. Takes
/// some seconds. Returns what was written; null: cancelled.
Json WriteViews(const ExperimentSettings &settings, const LabScene &scene, size_t sampler, const Integrator &integrator,
                Progress &cancel);

/// The name of the note in the records that keeps what WriteViews returned.
std::string ViewsNote(const SamplerChoice &choice);
/// True: all pictures that the note names exist, with the file sizes that it names.
bool ViewsAreWhole(const ExperimentSettings &settings, const Json &note);

/// Adds "views" to results.json, for the scene and for every sampler whose views were written.
void AddViews(const ExperimentSettings &settings, const RecordFolder &records, Json *results);

}  // namespace ext::lab
