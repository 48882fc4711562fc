#pragma once

/// Of this build. Their file is compiled by itself: they change with every commit and with what is installed.
namespace bodesmith::build {

extern const char* const kCommit;
extern const char* const kDate;  ///< of the commit
extern const char* const kCompiler;
extern const char* const kFlags;
extern const char* const kBuildType;
extern const char* const kSystem;
extern const char* const kOptions;
extern const char* const kLibraries;

}  // namespace bodesmith::build
