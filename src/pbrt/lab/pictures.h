#pragma once
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "pbrt/images/image.h"

namespace pbrt::lab {

/// What linear values are multiplied with before the PNG's sRGB curve cuts them at 1: the 98th percentile of the
/// reference's luminance becomes 0.9. Every picture of a campaign is shown with the same one.
double ChooseExposure(const Image &reference);
void WritePicture(const std::string &path, const Image &image, double exposure);

/// Relative error of every pixel as relL2 weighs it, |x - r| / sqrt(r^2 + 0.01), root of the mean square over R, G, B.
std::vector<float> ErrorMap(const Image &image, const Image &reference);
/// End of the colour scale for several maps: the 99th percentile of the map where that is largest.
double ChooseErrorScale(std::span<const std::vector<float>> maps);
/// False colour, dark to bright, from 0 to `most`.
void WriteErrorPicture(const std::string &path, const std::vector<float> &map, Point2i resolution, double most);

/// Up to three square parts, 64 pixels wide (a quarter of the shorter side in small pictures, at least 8), that do not
/// overlap: where the largest root-mean-square error of a sampler exceeds that of the best one most. `maps`: one a
/// sampler. Candidates lie on a grid of half their width; ties go to the upper left one.
std::vector<Bounds2i> ChooseCrops(std::span<const std::vector<float>> maps, Point2i resolution);

}  // namespace pbrt::lab
