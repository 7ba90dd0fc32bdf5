#pragma once
#include <span>
#include <string>
#include <vector>

#include "ext/lab/text_output.h"
#include "pbrt/images/image.h"

namespace ext::lab {
using namespace pbrt;

/// Exposure factor before the PNG's sRGB curve, which clips at 1, from the reference's luminances. Maps the median of
/// the non-black pixels to mid grey, 0.18, so that interiors are visible, but keeps three quarters of these pixels
/// below 0.9. Never below the factor that maps the 98th percentile to 0.9. Shared by all images of an experiment.
double ChooseExposure(const Image &reference);
void WritePicture(const std::string &path, const Image &image, double exposure);
/// Writes R, G, B with full range as a Radiance file: shared exponent, 8 bits per colour, no run-length coding. The
/// page shows it at any exposure.
void WriteRangePicture(const std::string &path, const Image &image);

/// Per-pixel relative error as weighted by relL2, |x - r| / sqrt(r^2 + RelL2Epsilon), root mean square over R, G, B.
std::vector<float> ErrorMap(const Image &image, const Image &reference);
/// Colour scale limit for several maps: the maximum of their 99th percentiles.
double ChooseErrorScale(std::span<const std::vector<float>> maps);
/// Writes the map in false colours from 0 to `most`.
void WriteErrorPicture(const std::string &path, const std::vector<float> &map, Point2i resolution, double most);

/// Up to three disjoint square crops that maximize the difference between the samplers' largest and smallest RMS error.
/// Side: 64 pixels (a quarter of the shorter side in small images, at least 8). `maps`: one per sampler. Candidates lie
/// on a grid of half their width; ties go to the upper left.
std::vector<Bounds2i> ChooseCrops(std::span<const std::vector<float>> maps, Point2i resolution);

}  // namespace ext::lab
