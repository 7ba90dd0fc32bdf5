#pragma once
#include <memory>

#include "pbrt/core/factory_table.h"
#include "pbrt/math/bounds.h"

namespace pbrt {

/// Sample position relative to a pixel centre, and its weight f / (pdf * integral of f): 1 on average, exactly 1 for
/// filters without negative lobes.
struct FilterSample {
    Point2 offset{};
    Float weight = 1;
};

/// Importance-sampled reconstruction filter: every camera sample affects one pixel (pbrt-v4-format §5.3).
class Filter {
  public:
    virtual ~Filter() = default;
    Vector2 Radius() const { return radius_; }               ///< half widths, in pixels
    virtual Float Evaluate(const Point2 &p) const = 0;       ///< p: relative to the pixel centre, in pixels
    virtual Float Integral() const = 0;                      ///< of Evaluate over the plane
    virtual FilterSample Sample(const Point2 &u) const = 0;  ///< u: uniform on the unit square
    /// Density of Sample at p, by area; for tabulated filters (gaussian, mitchell, sinc) that of the table.
    virtual Float Pdf(const Point2 &p) const { return Evaluate(p) / Integral(); }

  protected:
    explicit Filter(const Vector2 &radius) : radius_(radius) {}
    Vector2 radius_;
};

struct FilterContext {
    DiagnosticSink &sink;
};
using FilterTable = FactoryTable<std::unique_ptr<Filter>, const FilterContext>;
const FilterTable &Filters();

}  // namespace pbrt
