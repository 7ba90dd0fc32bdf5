#pragma once
#include "pbrt/lab/lab_scene.h"
#include "pbrt/lab/run_record.h"

namespace pbrt::lab {

/// Pictures of what a sampler of the campaign knows, over what the camera sees first: <sampler>/views/*.png; with the
/// first one also those that are the same for every sampler: views/*.png. Takes some seconds. Returns what was
/// written; null: cancelled.
nlohmann::ordered_json WriteViews(const CampaignSettings &settings, const LabScene &scene, size_t sampler,
                                  const LightSampler &lights, Progress &cancel);

/// Where the records keep what WriteViews returned.
std::string ViewsNote(const SamplerChoice &choice);
/// Are all the pictures there that the note names, with the sizes they had?
bool ViewsAreWhole(const CampaignSettings &settings, const nlohmann::ordered_json &note);

/// "views" of results.json, for the scene and for every sampler that was looked at.
void AddViews(const CampaignSettings &settings, const RecordFolder &records, nlohmann::ordered_json *results);

}  // namespace pbrt::lab
