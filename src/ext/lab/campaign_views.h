#pragma once
#include "ext/lab/lab_scene.h"
#include "ext/lab/run_record.h"

namespace pbrt::lab {

/// Writes pictures of what a sampler of the campaign knows at the surfaces that the camera sees first, as
/// <sampler>/views/*.png. For sampler 0 it also writes those that are the same for every sampler, as views/*.png. Takes
/// some seconds. Returns what was written; null: cancelled.
nlohmann::ordered_json WriteViews(const CampaignSettings &settings, const LabScene &scene, size_t sampler,
                                  const Integrator &integrator, Progress &cancel);

/// The name of the note in the records that keeps what WriteViews returned.
std::string ViewsNote(const SamplerChoice &choice);
/// True: all pictures that the note names exist, with the file sizes that it names.
bool ViewsAreWhole(const CampaignSettings &settings, const nlohmann::ordered_json &note);

/// Adds "views" to results.json, for the scene and for every sampler whose views were written.
void AddViews(const CampaignSettings &settings, const RecordFolder &records, nlohmann::ordered_json *results);

}  // namespace pbrt::lab
