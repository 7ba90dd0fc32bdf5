#include "ext/visibility/visibility_tree.h"

namespace ext {

const std::array<Float, 256> &VisibilityTree::Table() {
    static const std::array<Float, 256> table = [] {
        std::array<Float, 256> t;
        for (int i = 0; i < 256; ++i) t[size_t(i)] = std::exp2((Float(i) - 192) / 8);
        return t;
    }();
    return table;
}

}  // namespace ext
