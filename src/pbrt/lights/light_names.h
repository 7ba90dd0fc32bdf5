#pragma once
#include <string>
#include <vector>

#include "pbrt/core/error.h"
#include "pbrt/core/ids.h"

namespace pbrt {

/// Where the lights of a LightTable come from in the scene file (its name without folders), for people. One small entry
/// a directive, however many lights it makes; nothing of the file's text is kept.
class LightNames {
  public:
    /// The next `count` lights, in the order of their ids. `what`: the directive as it is called, e.g. LightSource
    /// "point". `shape`: of the Shape directive whose primitives emit; none for other lights. `primitive`: what one of
    /// them is called.
    void Add(size_t count, const std::string &what, const FileLoc &light, const FileLoc &shape = {},
             const std::string &primitive = {});

    /// AreaLightSource "diffuse" at room.pbrt:123, shape at :125, triangle 3 of 12.
    std::string NameOf(LightId light) const;
    /// Of `count` lights from `first` on: as NameOf, but "12 triangles" if they are more than one of the same
    /// directive.
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
    std::vector<std::string> texts_ = {""};  ///< names of files and directives: few
    size_t end_ = 0;
};

}  // namespace pbrt
