/* The folder of an FMU's own files, by how each standard names it, and files in it that can be read to their end. */
#ifndef RESOURCES_H
#define RESOURCES_H

#include <ctype.h>
#include <errno.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>
#if defined(__unix__) || defined(__APPLE__) || defined(_WIN32)
#include <sys/types.h>

#include <sys/stat.h>
#endif

enum { RESOURCES_PROBLEM = 320 };

/* True if paths begin with the letter of a drive, and a host's name in a URI is that of a share. */
#ifndef RESOURCES_ON_DRIVES
#ifdef _WIN32
#define RESOURCES_ON_DRIVES 1
#else
#define RESOURCES_ON_DRIVES 0
#endif
#endif

/* Return whether a string begins with these letters, capital or not. */
static inline bool resources_begins(const char *text, const char *letters) {
    while (*letters && tolower((unsigned char)*text) == *letters) ++text, ++letters;
    return !*letters;
}

/* Return the length of the scheme of a URI, RFC 3986, section 3.1; 0 if it has none. One letter is that of a drive. */
static inline size_t resources_scheme(const char *text) {
    size_t length = 0;
    if (!isalpha((unsigned char)*text)) return 0;
    while (isalnum((unsigned char)text[length]) || (text[length] && strchr("+-.", text[length]))) ++length;
    return text[length] == ':' && length > 1 ? length : 0;
}

/* Remove separators at the end of a folder's name, but not that of the root. */
static inline void resources_trim(char *path) {
    size_t length = strlen(path);
    while (length > 1 && (path[length - 1] == '/' || (RESOURCES_ON_DRIVES && path[length - 1] == '\\'))) path[--length] = '\0';
}

/* Decode the rest of a URI, after the scheme and the host's name, into a path; false if it holds a zero byte. */
static inline bool resources_decode(const char *uri, char *path) {
    static const char digits[] = "0123456789abcdef";
    while (*uri) {
        const char *high = uri[0] == '%' && uri[1] ? strchr(digits, tolower((unsigned char)uri[1])) : NULL;
        const char *low = high && uri[2] ? strchr(digits, tolower((unsigned char)uri[2])) : NULL;
        if (low && high == digits && low == digits) return false;
        *path++ = low ? (char)(16 * (high - digits) + (low - digits)) : *uri;
        uri += low ? 3 : 1;
    }
    *path = '\0';
    return true;
}

/* Return the part after "file:" and the name of this host; NULL if it is on another host. RFC 8089, appendices B and E. */
static inline const char *resources_behind_host(const char *uri) {
    if (uri[0] != '/' || uri[1] != '/') return uri;
    const size_t length = strcspn(uri + 2, "/");
    const bool here = length == 0 || (length == 9 && resources_begins(uri + 2, "localhost"));
    const bool drive = RESOURCES_ON_DRIVES && length == 2 && isalpha((unsigned char)uri[2]) && (uri[3] == ':' || uri[3] == '|');
    if (here || drive) return uri + 2 + (drive ? 0 : length);
    return RESOURCES_ON_DRIVES ? uri : NULL; /* "//server/share" */
}

/* FMI 2.0, section 2.1.5: a URI. Some hosts give a path, which is taken as it is. `path` must have room for the given string.
 * Returns false, with one message, on error. */
static inline bool resources_of_uri(const char *uri, char *path, char problem[RESOURCES_PROBLEM]) {
    const char *wanted = "fmuResourceLocation must be the URI of a folder on this computer, such as file:///folder/resources";
    const size_t scheme = resources_scheme(uri);
    const char *rest = uri;
    if (scheme == 4 && resources_begins(uri, "file:")) {
        rest = resources_behind_host(uri + 5);
        if (rest && RESOURCES_ON_DRIVES && rest[0] == '/' && isalpha((unsigned char)rest[1]) &&
            (rest[2] == ':' || rest[2] == '|'))
            ++rest;
        if (rest && !resources_decode(rest, path)) rest = NULL;
        if (rest && RESOURCES_ON_DRIVES && isalpha((unsigned char)path[0]) && path[1] == '|') path[1] = ':';
    } else if (scheme && strncmp(uri + scheme, "://", 3) == 0) {
        rest = NULL;
    } else {
        strcpy(path, uri);
    }
    if (!rest) {
        snprintf(problem, RESOURCES_PROBLEM, "%s; got %.120s.", wanted, uri);
        return false;
    }
    resources_trim(path);
    return true;
}

/* FMI 3.0, section 2.3.1: a path, in which a % is a letter as any. */
static inline bool resources_of_path(const char *given, char *path, char problem[RESOURCES_PROBLEM]) {
    if (resources_begins(given, "file:")) {
        snprintf(problem, RESOURCES_PROBLEM,
                 "resourcePath must be the path of a folder; got the URI %.120s. Give /folder/resources in place of "
                 "file:///folder/resources.",
                 given);
        return false;
    }
    strcpy(path, given);
    resources_trim(path);
    return true;
}

/* Return whether a path is a regular file, which has an end: reading a pipe could wait indefinitely. True if that cannot be
 * determined. */
static inline bool is_plain_file(const char *path) {
#if defined(_WIN32)
    struct _stat about;
    return _stat(path, &about) != 0 || (about.st_mode & _S_IFMT) == _S_IFREG;
#elif defined(__unix__) || defined(__APPLE__)
    struct stat about;
    return stat(path, &about) != 0 || S_ISREG(about.st_mode);
#else
    (void)path;
    return true;
#endif
}

/* Open a file for reading. NULL if it does not exist, or with the reason in `why`. */
static inline FILE *resources_open(const char *path, const char **why) {
    *why = NULL;
    if (!is_plain_file(path)) {
        *why = "is a folder, a pipe or a device";
        return NULL;
    }
    errno = 0;
    FILE *file = fopen(path, "rb");
    if (!file && errno != ENOENT && errno != ENOTDIR)
        *why = errno == ENAMETOOLONG ? "has a path that is too long" : "cannot be opened";
    return file;
}

#endif
