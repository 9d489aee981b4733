#pragma once

/// Exports a symbol from the shared library. All other symbols are hidden.
#define CBMV_API __attribute__((visibility("default")))
