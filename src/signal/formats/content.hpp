#pragma once

namespace bodesmith::formats {

/// What a command wants of a file: a plain table without a header can be either.
enum class Content { any, response, record };

}  // namespace bodesmith::formats
