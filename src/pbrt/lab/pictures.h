#pragma once
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "pbrt/images/image.h"

namespace pbrt::lab {

/// What linear values are multiplied with before the PNG's sRGB curve cuts them at 1, from the luminances of the
/// reference. The median (of what is not black) becomes mid grey, 0.18, so that a room is seen and not its windows; but
/// where most of the picture is dark, three quarters of it stay below 0.9. Never darker than with the 98th percentile
/// at 0.9. Every picture of a campaign is shown with the same one.
double ChooseExposure(const Image &reference);
void WritePicture(const std::string &path, const Image &image, double exposure);
/// R, G, B with their range as a Radiance file: one exponent a pixel, 8 bits a colour, not run-length coded. The page
/// shows it at any exposure.
void WriteRangePicture(const std::string &path, const Image &image);

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
