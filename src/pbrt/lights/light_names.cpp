#include "pbrt/lights/light_names.h"

#include <algorithm>
#include <filesystem>

namespace pbrt {

uint32_t LightNames::IndexOf(const std::string &text) {
    // Backwards: consecutive directives mostly have the same type and file.
    const auto found = std::find(texts_.rbegin(), texts_.rend(), text);
    if (found != texts_.rend()) return uint32_t(texts_.rend() - found - 1);
    texts_.push_back(text);
    return uint32_t(texts_.size() - 1);
}

LightNames::Place LightNames::PlaceOf(const FileLoc &loc) {
    return loc ? Place{IndexOf(std::filesystem::path(loc.file->name).filename().string()), loc.line} : Place{};
}

void LightNames::Add(size_t count, const std::string &what, const FileLoc &light, const FileLoc &shape,
                     const std::string &primitive) {
    if (count == 0) return;
    entries_.push_back({uint32_t(end_), IndexOf(what), IndexOf(primitive), PlaceOf(light), PlaceOf(shape)});
    end_ += count;
}

std::string LightNames::Text(const Place &place, uint32_t fileSaidBefore) const {
    if (place.line <= 0) return {};
    return fmt::format("{}:{}", place.file == fileSaidBefore ? "" : texts_[place.file], place.line);
}

std::string LightNames::NameOf(LightId light) const { return NameOf(light, 1); }

std::string LightNames::NameOf(LightId first, size_t count) const {
    if (!first || first.value >= end_) return {};
    const auto after = std::upper_bound(entries_.begin(), entries_.end(), first.value,
                                        [](uint32_t id, const Entry &e) { return id < e.first; });
    const Entry &entry = *(after - 1);
    const size_t all = (after == entries_.end() ? end_ : after->first) - entry.first;
    std::string name = texts_[entry.what];
    if (const std::string at = Text(entry.light, 0); !at.empty()) name += " at " + at;
    if (const std::string at = Text(entry.shape, entry.light.file); !at.empty()) name += ", shape at " + at;
    const std::string &primitive = texts_[entry.primitive];
    if (all > 1 && count == 1) name += fmt::format(", {} {} of {}", primitive, first.value - entry.first + 1, all);
    if (count > 1) name += fmt::format(", {} {}{}", count, primitive, primitive.ends_with("ch") ? "es" : "s");
    return name;
}

}  // namespace pbrt
