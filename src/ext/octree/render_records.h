#pragma once
#include "ext/octree/visibility_records.h"
#include "pbrt/lightsamplers/light_learner.h"

namespace ext {

/// What shadow rays of the render found, as records of one try each. Every sample has a place of its own, so that the
/// order in which threads come by does not matter.
class RenderRecords {
  public:
    /// For samples [first, end) of these pixels and up to `vertices` vertices of their paths. At most `most` places:
    /// where there are more samples than that, of every second, third, ... pixel.
    void Begin(const Bounds2i &pixels, int first, int end, int vertices, size_t most);
    /// Forgets all, and takes no more.
    void End();

    LightLearner::PathPlaces BeginPath(Point2i pixel, int sample) const;
    /// At the next vertex of a path. `weight`: see VisibilityTry.
    void Add(LightLearner::PathPlaces &path, const Point3 &p, const VisibilityTry &found) {
        if (path.next < path.end) places_[path.next++] = {p, found};
    }
    void AppendTo(VisibilityRecords *records) const;

  private:
    struct Place {
        Point3 p{};
        VisibilityTry found;
    };
    Bounds2i pixels_;
    int first_ = 0, end_ = 0, stride_ = 1;
    size_t vertices_ = 0, placesPerRow_ = 0;
    std::vector<Place> places_;  ///< weight 0: empty
};

}  // namespace ext
