#pragma once
#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "pbrt/core/error.h"
#include "pbrt/core/ids.h"

namespace pbrt {

/// Names of a LightTable's lights for messages: directive and scene file location, without folders. Stores one small
/// entry per directive, independent of its number of lights.
class LightNames {
  public:
    /// Adds the next `count` lights, in id order. `what`: directive with type, e.g. LightSource "point". `shape`:
    /// location of the emitting Shape directive; empty for other lights. `primitive`: name of one primitive, e.g.
    /// triangle.
    void Add(size_t count, const std::string &what, const FileLoc &light, const FileLoc &shape = {},
             const std::string &primitive = {}) {
        if (count == 0) return;
        entries_.push_back({uint32_t(end_), IndexOf(what), IndexOf(primitive), PlaceOf(light), PlaceOf(shape)});
        end_ += count;
    }

    /// For example: AreaLightSource "diffuse" at room.pbrt:123, shape at :125, triangle 3 of 12. Several lights of one
    /// directive end in, e.g., "12 triangles".
    std::string NameOf(LightId first, size_t count = 1) const {
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
    size_t Size() const { return end_; }
    size_t EntryCount() const { return entries_.size(); }

  private:
    struct Place {
        uint32_t file = 0;  ///< index into texts_, 0: none
        int line = 0;
    };
    struct Entry {
        uint32_t first = 0, what = 0, primitive = 0;
        Place light, shape;
    };
    uint32_t IndexOf(const std::string &text) {
        // Backwards: consecutive directives mostly have the same type and file.
        const auto found = std::find(texts_.rbegin(), texts_.rend(), text);
        if (found != texts_.rend()) return uint32_t(texts_.rend() - found - 1);
        texts_.push_back(text);
        return uint32_t(texts_.size() - 1);
    }
    Place PlaceOf(const FileLoc &loc) {
        return loc ? Place{IndexOf(std::filesystem::path(loc.file->name).filename().string()), loc.line} : Place{};
    }
    std::string Text(const Place &place, uint32_t fileBefore) const {
        if (place.line <= 0) return {};
        return fmt::format("{}:{}", place.file == fileBefore ? "" : texts_[place.file], place.line);
    }

    std::vector<Entry> entries_;
    std::vector<std::string> texts_ = {""};  ///< file and directive names
    size_t end_ = 0;
};

}  // namespace pbrt
