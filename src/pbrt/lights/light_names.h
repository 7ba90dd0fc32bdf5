#pragma once
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
             const std::string &primitive = {});

    /// For example: AreaLightSource "diffuse" at room.pbrt:123, shape at :125, triangle 3 of 12.
    std::string NameOf(LightId light) const;
    /// The same for `count` lights of one directive from `first`; more than one end in, e.g., "12 triangles".
    std::string NameOf(LightId first, size_t count) const;
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
    uint32_t IndexOf(const std::string &text);
    Place PlaceOf(const FileLoc &loc);
    std::string Text(const Place &place, uint32_t fileSaidBefore) const;

    std::vector<Entry> entries_;
    std::vector<std::string> texts_ = {""};  ///< file and directive names
    size_t end_ = 0;
};

}  // namespace pbrt
