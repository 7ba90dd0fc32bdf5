#pragma once
#include "ext/octree/visibility_records.h"
#include "pbrt/lightsamplers/path_observer.h"

namespace ext {

/// What shadow rays of the render found, as records of one try each. Every sample of a pixel has its own place, so that
/// the result does not depend on the order in which threads write.
class RenderRecords {
  public:
    /// Makes places for samples [first, end) of these pixels and up to `vertices` vertices of their paths. If that is
    /// more than `most` places, only every second, third, ... pixel of a row is recorded, at least one in each row.
    void Begin(const Bounds2i &pixels, int first, int end, int vertices, size_t most);
    /// Frees all places; nothing is recorded until the next Begin.
    void End();

    PathObserver::PathPlaces BeginPath(Point2i pixel, int sample) const;
    /// Records `found` for the next vertex of a path, at point p. Beyond the last place nothing is recorded.
    void Add(PathObserver::PathPlaces &path, const Point3 &p, bool inMedium, const VisibilityTry &found) {
        if (path.next < path.end) places_[path.next++] = {p, inMedium, found};
    }
    void Save(StateWriter &writer) const;
    /// Throws UserError if what was saved has other places than this object (Begin).
    void Load(StateReader &reader);
    /// See OnlineModel.
    void Take(StateWriter &writer);
    void Add(StateReader &reader);
    /// Appends what was found on surfaces, or what was found inside media.
    void AppendTo(VisibilityRecords *records, bool inMedium) const;

  private:
    struct Place {
        Point3 p{};
        bool inMedium = false;
        VisibilityTry found;
    };
    Bounds2i pixels_;
    int first_ = 0, end_ = 0, stride_ = 1;
    size_t vertices_ = 0, placesPerRow_ = 0;
    std::vector<Place> places_;  ///< weight 0: empty
};

}  // namespace ext
