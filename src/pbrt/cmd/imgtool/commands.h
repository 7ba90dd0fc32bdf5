#pragma once
#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <vector>

#include "pbrt/images/image.h"

namespace pbrt::imgtool {

/// What a chosen command does; returns the exit status. Throws UserError.
using Action = std::function<int()>;

// Each adds its subcommand to `app` and sets `action` when the subcommand is chosen. `action` outlives the parsing.
void AddInfo(CLI::App &app, Action &action);
void AddConvert(CLI::App &app, Action &action);
void AddDiff(CLI::App &app, Action &action);
void AddFalsecolor(CLI::App &app, Action &action);
void AddAverage(CLI::App &app, Action &action);

/// "R,G,B" -> the names. Throws UserError if a name is empty.
std::vector<std::string> SplitChannels(const std::string &list);

/// Four numbers x0,x1,y0,y1, half-open, of pixels stored in the file, inside `resolution`. Throws UserError.
Bounds2i CropBounds(const std::vector<int> &numbers, Point2i resolution, const std::string &path);
/// Crops the pixels and moves the data window along.
void ApplyCrop(ImageFile &file, const std::vector<int> &numbers, const std::string &path);

/// Adds --crop to a subcommand.
CLI::Option *AddCropOption(CLI::App &command, std::vector<int> &numbers);

/// Reads an image; its pixels become float.
ImageFile ReadAsFloat(const std::string &path);

}  // namespace pbrt::imgtool
