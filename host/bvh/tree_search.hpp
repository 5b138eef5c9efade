// The search for a better tree while the first one is traced. Queries make it: host/trace/learning.
#pragma once

namespace claray {

class TreeSearch {
public:
    virtual ~TreeSearch() = default;
    /// Ends the search for good, and no query traces its tree any more. Waits while the first tree is in use.
    virtual void stop() = 0;
    [[nodiscard]] virtual bool has_found() const = 0;
};

}  // namespace claray
