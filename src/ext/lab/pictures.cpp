#include "ext/lab/pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "ext/lab/inspect.h"
#include "pbrt/images/false_color.h"

namespace ext::lab {
namespace {

namespace fs = std::filesystem;

double Percentile(std::vector<float> values, double share) {
    if (values.empty()) return 0;
    auto at = values.begin() + ptrdiff_t(share * double(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    return double(*at);
}

/// Writes `path` + ".png", and ".hdr" without exposure.
void WritePicture(const std::string &path, const Image &image, double exposure) {
    Image shown(PixelFormat::Float, image.Resolution(), {"R", "G", "B"});
    ForEachPixel(image.Resolution(), [&](int x, int y) {
        for (int c = 0; c < 3; ++c)
            shown.Set({x, y}, c, std::clamp(image.Get({x, y}, c) * Float(exposure), Float(0), Float(1)));
    });
    WriteImage(path + ".png", shown);
    WriteRangeImage(path + ".hdr", image);
}

/// Per-pixel relative error as weighted by relL2, |x - r| / sqrt(r^2 + RelL2Epsilon), root mean square over R, G, B.
Image ErrorMap(const Image &image, const Image &reference) {
    Image terms, map(PixelFormat::Float, image.Resolution(), {"Y"});
    ImageError(image, reference, Metric::RelL2, &terms);
    ForEachPixel(image.Resolution(), [&](int x, int y) {
        double sum = 0;
        for (int c = 0; c < 3; ++c) sum += double(terms.Get({x, y}, c));
        map.Set({x, y}, 0, std::isfinite(sum) ? Float(std::sqrt(sum / 3)) : 0);
    });
    return map;
}

/// Colour scale limit for several maps: the maximum of their 99th percentiles.
double ChooseErrorScale(std::span<const Image> maps) {
    double largest = 0;
    for (const Image &map : maps) {
        const auto *values = static_cast<const float *>(map.Data());
        largest = std::max(largest, Percentile({values, values + map.ValueCount()}, 0.99));
    }
    return largest > 0 ? largest : 1;
}

/// Up to three disjoint square crops that maximize the difference between the samplers' largest and smallest RMS error.
/// Side: 64 pixels (a quarter of the shorter side in small images, at least 8). `maps`: one per sampler. Candidates lie
/// on a grid of half their width; ties go to the upper left.
std::vector<Bounds2i> ChooseCrops(std::span<const Image> maps, Point2i resolution) {
    const int shorter = std::min(resolution.x, resolution.y);
    const int side = std::min(shorter, std::min(64, std::max(8, shorter / 4)));
    const int step = std::max(1, side / 2);
    struct Candidate {
        Bounds2i pixels;
        double score;
    };
    std::vector<Candidate> candidates;
    for (int y = 0; y + side <= resolution.y; y += step)
        for (int x = 0; x + side <= resolution.x; x += step) {
            const Bounds2i square{{x, y}, {x + side, y + side}};
            double smallest = std::numeric_limits<double>::infinity(), largest = 0;
            for (const Image &map : maps) {
                double sum = 0;
                ForEachPixel(square, [&](int u, int v) { sum += Sqr(double(map.Get({u, v}, 0))); });
                smallest = std::min(smallest, sum);
                largest = std::max(largest, sum);
            }
            if (!maps.empty()) candidates.push_back({square, std::sqrt(largest) - std::sqrt(smallest)});
        }
    std::ranges::stable_sort(candidates, std::ranges::greater(), &Candidate::score);
    std::vector<Bounds2i> crops;
    for (const Candidate &c : candidates) {
        auto overlaps = [&](const Bounds2i &o) { return !Intersect(c.pixels, o).IsEmpty(); };
        if (std::ranges::none_of(crops, overlaps)) crops.push_back(c.pixels);
        if (crops.size() == 3) break;
    }
    return crops;
}

/// Name of the record that stores what WriteViews wrote.
std::string ViewsNote(const ExperimentContext &context, size_t sampler) {
    return context.settings.samplers[sampler].folder + "/views.json";
}

}  // namespace

double ChooseExposure(const Image &reference) {
    const Rgb weights = ColorSpace::SRGB().Luminance();
    std::vector<float> luminances;
    ForEachPixel(reference.Resolution(), [&](int x, int y) {
        Float l = 0;
        for (int c = 0; c < 3; ++c) l += weights[c] * reference.Get({x, y}, c);
        if (std::isfinite(l) && l > 0) luminances.push_back(l);
    });
    if (luminances.empty()) return 1;
    const double middle = Percentile(luminances, 0.5), high = Percentile(luminances, 0.75),
                 bright = Percentile(luminances, 0.98);
    return std::max(0.9 / bright, std::min(0.18 / middle, 0.9 / high));
}

void WriteRangeImage(const std::string &path, const Image &image) {
    const Point2i resolution = image.Resolution();
    std::string text = fmt::format("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {} +X {}\n", resolution.y, resolution.x);
    ForEachPixel(resolution, [&](int x, int y) {
        double color[3], brightest = 0;
        for (int c = 0; c < 3; ++c) {
            const auto v = double(image.Get({x, y}, c));
            color[c] = std::isfinite(v) ? std::max(v, 0.0) : 0;
            brightest = std::max(brightest, color[c]);
        }
        int exponent = 0;
        std::frexp(brightest, &exponent);
        const bool isBlack = !(brightest > 0) || exponent < -127;
        exponent = std::min(exponent, 127);
        for (double v : color)
            text += isBlack ? '\0' : char(uint8_t(std::min(std::floor(std::ldexp(v, 8 - exponent)), 255.0)));
        text += isBlack ? '\0' : char(uint8_t(exponent + 128));
    });
    WriteFile(path, text);
}

bool WriteViews(const ExperimentContext &context, size_t sampler, const Integrator &integrator) {
    // Coarser than `lightlab inspect`: some seconds on two cores for any number of lights.
    const InspectSettings how{.samples = 8, .shownLights = sampler > 0 ? 0 : 4, .maxWork = 2e7};
    const Inspection inspection =
        InspectLights(context.scene.built, *integrator.Lights(), &integrator, how, context.cancel);
    if (context.cancel.Cancelled()) return false;
    const std::string &out = context.settings.outFolder;
    auto write = [&](const std::string &prefix, bool ofScene) {
        return WriteLayers(inspection, out, prefix, 0, [&](const InspectedLayer &layer) {
            return layer.name != "hit" && layer.ofScene == ofScene;
        });
    };
    Json views;
    views["everyNthPixel"] = inspection.stride;
    views["samplesPerLight"] = how.samples;
    views["layers"] = write(context.settings.samplers[sampler].folder + "/views/", false);
    if (sampler == 0) views["layersOfScene"] = write("views/", true);
    views["bytes"] = Json::object();
    for (const char *part : {"layers", "layersOfScene"})
        for (const Json &layer : views.value(part, Json::array()))
            if (layer.at("file").is_string()) {
                const std::string file = layer.at("file");
                views["bytes"][file] = fs::file_size(fs::path(out) / file);
            }
    context.records.SaveNote(ViewsNote(context, sampler), views);
    return true;
}

bool HasViews(const ExperimentContext &context, size_t sampler) {
    const Json views = context.records.LoadNote(ViewsNote(context, sampler));
    if (!views.is_object()) return false;
    std::error_code error;
    for (const auto &[file, bytes] : views.at("bytes").items())
        if (fs::file_size(fs::path(context.settings.outFolder) / file, error) != bytes || error) return false;
    return true;
}

void AddViews(const ExperimentContext &context, Json *results) {
    for (size_t i = 0; i < context.settings.samplers.size(); ++i) {
        const Json views = context.records.LoadNote(ViewsNote(context, i));
        if (!views.is_object()) continue;
        auto part = [&](const char *layers) {
            return Json{{"everyNthPixel", views.at("everyNthPixel")},
                        {"samplesPerLight", views.at("samplesPerLight")},
                        {"layers", views.at(layers)}};
        };
        (*results)["samplers"][i]["views"] = part("layers");
        if (views.contains("layersOfScene")) (*results)["views"] = part("layersOfScene");
    }
}

void WritePictures(const ExperimentContext &context, const References &references,
                   const std::vector<std::vector<Image>> &pictures, Json *json) {
    const auto &[settings, scene, registry, records, cancel, display] = context;
    const double exposure = ChooseExposure(references.all[0].image);
    (*json)["references"] = Json::array();
    for (size_t i = 0; i < references.all.size(); ++i) {
        const Reference &r = references.all[i];
        const std::string name = fmt::format("reference-{}", i);
        const ImageMetadata metadata = scene.Metadata(*scene.built.film, r.sampler, r.samples, r.seconds);
        const std::string file = settings.outFolder + "/" + name;
        WriteImage(file + ".exr", r.image, metadata);
        WritePicture(file, r.image, exposure);
        (*json)["references"].push_back({{"file", name + ".exr"},
                                         {"picture", name + ".png"},
                                         {"pictureRange", name + ".hdr"},
                                         {"sampler", r.sampler.empty() ? Json() : Json(r.sampler)},
                                         {"samples", r.samples ? Json(r.samples) : Json()},
                                         {"seconds", r.seconds > 0 ? Json(r.seconds) : Json()},
                                         {"noise", r.noise ? Json(*r.noise) : Json()},
                                         {"source", r.source}});
    }
    std::vector<Image> maps, shared;
    for (size_t i = 0; i < settings.samplers.size(); ++i) {
        maps.push_back(ErrorMap(pictures[i].front(), references.all[references.ofSampler[i]].image));
        if (!settings.samplers[i].traits.isInstrument) shared.push_back(maps.back());
    }
    const double scale = ChooseErrorScale(maps);
    const FalseColorStyle style{.max = Float(scale)};
    for (size_t i = 0; i < settings.samplers.size(); ++i) {
        const std::string folder = settings.outFolder + "/" + settings.samplers[i].folder;
        WritePicture(folder + "/result", pictures[i].front(), exposure);
        WriteImage(folder + "/error.png", FalseColor(maps[i], 0, style));
    }
    (*json)["exposure"] = exposure;
    (*json)["errorScale"] = scale;
    (*json)["crops"] = Json::array();
    const std::vector<Bounds2i> crops =
        settings.crops.empty() ? ChooseCrops(shared, references.all[0].image.Resolution()) : settings.crops;
    for (size_t i = 0; i < crops.size(); ++i) {
        const auto &[low, high] = crops[i];
        const std::string name(1, char('a' + i % 26));
        (*json)["crops"].push_back({{"name", name}, {"x0", low.x}, {"y0", low.y}, {"x1", high.x}, {"y1", high.y}});
    }
}

}  // namespace ext::lab
