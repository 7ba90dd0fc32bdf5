#include <cmath>
#include <nlohmann/json.hpp>

#include "pbrt/cmd/imgtool/commands.h"

namespace pbrt::imgtool {
namespace {

using Json = nlohmann::ordered_json;

struct ChannelStatistics {
    Float low = Infinity, high = -Infinity;
    double sum = 0;
    size_t count = 0, nan = 0, infinite = 0;
};

ChannelStatistics Statistics(const Image &image, int channel) {
    ChannelStatistics s;
    ForEachPixel(image, [&](Point2i p) {
        const Float v = image.Get(p, channel);
        if (std::isnan(v)) {
            ++s.nan;
        } else if (std::isinf(v)) {
            ++s.infinite;
        } else {
            s.low = std::min(s.low, v);
            s.high = std::max(s.high, v);
            s.sum += double(v);
            ++s.count;
        }
    });
    return s;
}

const char *FormatName(PixelFormat format) {
    constexpr const char *kNames[] = {"8 bit", "half", "float"};
    return kNames[size_t(format)];
}

/// Shortest decimal number that identifies the float.
double ShortNumber(Float v) { return std::stod(fmt::format("{}", v)); }

struct AttributeJson {
    Json operator()(const auto &v) const { return v; }
    Json operator()(float v) const { return ShortNumber(v); }
    Json operator()(const glm::mat4 &m) const {
        Json rows = Json::array();
        for (int row = 0; row < 4; ++row)
            rows.push_back(
                {ShortNumber(m[0][row]), ShortNumber(m[1][row]), ShortNumber(m[2][row]), ShortNumber(m[3][row])});
        return rows;
    }
};

void PrintAttribute(const std::string &name, const ImageMetadata::Value &value) {
    fmt::print("  {}: ", name);
    std::visit(
        []<class T>(const T &v) {
            if constexpr (std::is_same_v<T, glm::mat4>)
                for (int row = 0; row < 4; ++row)
                    fmt::print("{}    {:12.6g} {:12.6g} {:12.6g} {:12.6g}\n", row == 0 ? "\n" : "", v[0][row],
                               v[1][row], v[2][row], v[3][row]);
            else if constexpr (std::is_same_v<T, std::string>) fmt::print("\"{}\"\n", v);
            else fmt::print("{}\n", v);
        },
        value);
}

/// nlohmann::json writes non-finite numbers as null.
Json InfoJson(const std::string &path) {
    const ImageFile file = ReadImage(path);
    const ImageMetadata &metadata = file.metadata;
    Json json = {{"file", path},
                 {"width", file.image.Resolution().x},
                 {"height", file.image.Resolution().y},
                 {"format", FormatName(file.image.Format())},
                 {"colorSpace", metadata.colorSpace ? Json(metadata.colorSpace->Name()) : Json()}};
    if (metadata.fullResolution && metadata.pixelBounds) {
        const Bounds2i &b = *metadata.pixelBounds;
        json["window"] = {{"x0", b.low.x}, {"x1", b.high.x}, {"y0", b.low.y}, {"y1", b.high.y}};
        json["fullWidth"] = metadata.fullResolution->x;
        json["fullHeight"] = metadata.fullResolution->y;
    }
    json["attributes"] = Json::object();
    for (const auto &[name, value] : metadata.attributes) json["attributes"][name] = std::visit(AttributeJson{}, value);
    json["channels"] = Json::array();
    for (int c = 0; c < file.image.ChannelCount(); ++c) {
        const ChannelStatistics s = Statistics(file.image, c);
        Json channel = {{"name", file.image.Channels()[c]}};
        channel["min"] = s.count ? Json(ShortNumber(s.low)) : Json();
        channel["mean"] = s.count ? Json(s.sum / double(s.count)) : Json();
        channel["max"] = s.count ? Json(ShortNumber(s.high)) : Json();
        channel["nan"] = s.nan;
        channel["infinite"] = s.infinite;
        json["channels"].push_back(std::move(channel));
    }
    return json;
}

void PrintInfo(const std::string &path) {
    const ImageFile file = ReadImage(path);
    const Image &image = file.image;
    const ImageMetadata &metadata = file.metadata;
    fmt::print("{}\n", path);
    fmt::print("  resolution: {} x {}, {}, {}\n", image.Resolution().x, image.Resolution().y,
               CountText(image.ChannelCount(), "channel"), FormatName(image.Format()));
    if (metadata.fullResolution && metadata.pixelBounds)
        fmt::print("  window: {} of {} x {}\n", WindowText(file), metadata.fullResolution->x,
                   metadata.fullResolution->y);
    fmt::print("  colour space: {}\n", metadata.colorSpace ? metadata.colorSpace->Name() : "srgb (not stated)");
    for (const auto &[name, value] : metadata.attributes) PrintAttribute(name, value);
    fmt::print("  {:<16} {:>13} {:>13} {:>13} {:>8} {:>8}\n", "channel", "min", "mean", "max", "nan", "infinite");
    for (int c = 0; c < image.ChannelCount(); ++c) {
        const ChannelStatistics s = Statistics(image, c);
        const std::string &name = image.Channels()[c];
        if (s.count)
            fmt::print("  {:<16} {:>13.6g} {:>13.6g} {:>13.6g} {:>8} {:>8}\n", name, s.low, s.sum / double(s.count),
                       s.high, s.nan, s.infinite);
        else fmt::print("  {:<16} {:>13} {:>13} {:>13} {:>8} {:>8}\n", name, "-", "-", "-", s.nan, s.infinite);
    }
}

struct InfoOptions {
    std::vector<std::string> paths;
    bool json = false;
};

int Info(const InfoOptions &o) {
    Json all = Json::array();
    for (const std::string &path : o.paths)
        if (o.json) all.push_back(InfoJson(path));
        else PrintInfo(path);
    if (o.json) fmt::print("{}\n", all.dump(1, ' ', false, Json::error_handler_t::replace));
    return 0;
}

}  // namespace

void AddInfo(CLI::App &app, Action &action) {
    auto [command, o] =
        AddCommand(app, action, Info, "info", "Print resolution, colour space, metadata and channel statistics",
                   "Example: imgtool info render.exr");
    AddFlags(command, {Flag("files", o.paths, "Images").Required(),
                       {"--json", o.json, "Print a JSON array with an object for each image"}});
}

}  // namespace pbrt::imgtool
