#pragma once
#include <string>
#include <vector>

#include "ext/lab/reference.h"
#include "ext/lab/text_output.h"

namespace ext::lab {

/// Writes inspection views of a sampler at the first visible surfaces, as <sampler>/views/*.png; for sampler 0 also the
/// sampler-independent ones, as views/*.png. Takes some seconds. Records what was written. Returns false if cancelled.
bool WriteViews(const ExperimentContext &context, size_t sampler, const Integrator &integrator);
/// True if all recorded images of the sampler exist with their file sizes.
bool HasViews(const ExperimentContext &context, size_t sampler);
/// Adds "views" to results.json, for the scene and every sampler with views.
void AddViews(const ExperimentContext &context, Json *results);

/// Exposure factor before the PNG's sRGB curve, which clips at 1, from the reference's luminances. Maps the median of
/// the non-black pixels to mid grey, 0.18, so that interiors are visible, but keeps three quarters of these pixels
/// below 0.9. Never below the factor that maps the 98th percentile to 0.9. Shared by all images of an experiment.
double ChooseExposure(const Image &reference);
/// Writes R, G, B with full range as a Radiance file: shared exponent, 8 bits per colour, no run-length coding.
void WriteRangeImage(const std::string &path, const Image &image);

/// Writes references, results and errors as images, and adds them and the crops to `json`.
void WritePictures(const ExperimentContext &context, const References &references,
                   const std::vector<std::vector<Image>> &pictures, Json *json);

}  // namespace ext::lab
