#pragma once
#include <array>

#include "pbrt/cmd/flags.h"
#include "pbrt/images/image.h"
#include "pbrt/images/metrics.h"

namespace pbrt::imgtool {

/// Runs a command and returns the exit status. Throws UserError.
using Action = std::function<int()>;

/// Adds a subcommand to `app`; sets `action`, which must outlive parsing, if it is selected.
using CommandAdder = void(CLI::App &app, Action &action);
CommandAdder AddInfo, AddConvert, AddDiff, AddError, AddFalsecolor, AddAverage, AddAssemble, AddMerge, AddSplitn,
    AddBloom, AddWhitebalance, AddScalenormalmap, AddMakeequiarea, AddMakesky;

/// Adds a subcommand with action `run`. Returns it and the options to be declared.
template <class O>
std::pair<CLI::App &, O &> AddCommand(CLI::App &app, Action &action, int (*run)(const O &), const std::string &name,
                                      const std::string &about, const std::string &footer) {
    auto options = std::make_shared<O>();
    CLI::App *command = app.add_subcommand(name, about);
    command->footer(footer);
    command->callback([=, &action] { action = [=] { return run(*options); }; });
    return {*command, *options};
}

/// Splits "R,G,B" into names; wavelength channels may contain a comma. Throws UserError for empty names.
std::vector<std::string> SplitChannels(const std::string &list);
/// Indices of the channels R, G, B. Throws UserError if one is missing.
std::array<int, 3> RgbChannels(const Image &image, const std::string &path);
inline Rgb GetRgb(const Image &image, Point2i p, const std::array<int, 3> &channels) {
    return {image.Get(p, channels[0]), image.Get(p, channels[1]), image.Get(p, channels[2])};
}
inline void SetRgb(Image &image, Point2i p, const std::array<int, 3> &channels, const Rgb &rgb) {
    for (int c = 0; c < 3; ++c) image.Set(p, channels[c], rgb[c]);
}

/// Colour channels: all but alpha.
std::vector<int> ColorChannels(const Image &image);
/// Their mean, as channel Y.
Image AverageChannels(const Image &image);

std::string SizeText(const Image &image);
/// Colour space of the file; default sRGB.
const ColorSpace &SpaceOf(const ImageFile &file);

/// Data window of the file; default all pixels.
Bounds2i WindowOf(const ImageFile &file);
/// "x 0 to 8, y 0 to 4".
std::string WindowText(const ImageFile &file);
/// Crops to x0,x1,y0,y1 (half-open, in pixels of the whole image; none: everything) and sets the data window. Throws
/// UserError if they exceed the window.
void ApplyCrop(ImageFile &file, const std::vector<int> &numbers, const std::string &path);

Flag CropFlag(std::vector<int> &numbers);
/// The required flag --outfile. If `isPositional`, the bare name may follow the image.
Flag OutfileFlag(std::string &path, bool isPositional = false);

/// Metric by name. Throws UserError with the choices.
Metric ChosenMetric(const std::string &name);
/// Throws UserError unless resolution, data window, colour space and channels match; `hint`: for channels.
void CheckComparable(const ImageFile &a, const std::string &pathA, const ImageFile &b, const std::string &pathB,
                     const std::string &hint = "");

ImageFile ReadAsFloat(const std::string &path);
/// Files that match `names`, without duplicates. A name is a file, a pattern with * and ? in the last path component,
/// or a prefix of image paths. Pattern and prefix matches are sorted and exclude `except`, so that earlier results are
/// no input. Throws UserError for a name without match.
std::vector<std::string> FindImages(const std::vector<std::string> &names, const std::vector<std::string> &except);
inline constexpr const char *kImagesHelp =
    "Images: names of files, patterns in quotes such as 'runs/seed*.exr', or starts of names such as runs/seed";

}  // namespace pbrt::imgtool
