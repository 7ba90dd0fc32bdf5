#pragma once
#include <span>
#include <string>
#include <vector>

#include "ext/lab/text_output.h"
#include "pbrt/images/image.h"

namespace ext::lab {
using namespace pbrt;

/// Returns the factor on linear values before the PNG's sRGB curve, which clips at 1, chosen from the luminances of the
/// reference. The median of the pixels that are not black becomes mid grey, 0.18, so that a room is visible and not
/// only its windows; but three quarters of these pixels stay below 0.9. The factor is never smaller than the one that
/// puts the 98th percentile at 0.9. All pictures of an experiment use the same one.
double ChooseExposure(const Image &reference);
void WritePicture(const std::string &path, const Image &image, double exposure);
/// Writes R, G, B with their full range as a Radiance file: one exponent per pixel, 8 bits per colour, without
/// run-length coding. The page shows it at any exposure.
void WriteRangePicture(const std::string &path, const Image &image);

/// Returns the relative error of every pixel as relL2 weighs it, |x - r| / sqrt(r^2 + RelL2Epsilon), root of the mean
/// square over R, G, B.
std::vector<float> ErrorMap(const Image &image, const Image &reference);
/// Returns the end of the colour scale for several maps: the largest of their 99th percentiles.
double ChooseErrorScale(std::span<const std::vector<float>> maps);
/// Writes the map in false colours, dark to bright, from 0 to `most`.
void WriteErrorPicture(const std::string &path, const std::vector<float> &map, Point2i resolution, double most);

/// Returns up to three square crops, 64 pixels wide (a quarter of the shorter side in small pictures, at least 8), that
/// do not overlap: those where the largest root-mean-square error of a sampler exceeds the smallest one most. `maps`:
/// one per sampler. Candidates lie on a grid of half their width; ties go to the upper left one.
std::vector<Bounds2i> ChooseCrops(std::span<const std::vector<float>> maps, Point2i resolution);

}  // namespace ext::lab
