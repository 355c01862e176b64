/* The identity of an FMU with data of its own. Its token is not that of the binary, which many FMUs share. The resources hold
 * `identity.csv`, written by fmu_src/identity.py, with rows that name the token, that of the binary, and every file of data with
 * its size and CRC-32 (ISO 3309). So data that are missing or changed are found before a run. */
#ifndef IDENTITY_H
#define IDENTITY_H

#include "resources.h"

#include <stdlib.h>

enum { IDENTITY_ROW = 256 };

/* Return the CRC-32 of more bytes, from that of the bytes before; 0 at the start. */
static inline unsigned long identity_sum(unsigned long sum, const unsigned char *bytes, size_t count) {
    sum ^= 0xFFFFFFFFUL;
    for (size_t i = 0; i < count; ++i) {
        sum ^= bytes[i];
        for (int bit = 0; bit < 8; ++bit) sum = sum >> 1 ^ (sum & 1 ? 0xEDB88320UL : 0);
    }
    return sum ^ 0xFFFFFFFFUL;
}

/* Open a file of the folder; NULL, and why, if it cannot be read. */
static inline FILE *identity_open(const char *folder, const char *name, const char **why) {
    *why = "cannot be opened";
    char *path = (char *)malloc(strlen(folder) + strlen(name) + 2);
    if (!path) return NULL;
    strcat(strcat(strcpy(path, folder), "/"), name);
    FILE *file = resources_open(path, why);
    free(path);
    return file;
}

/* Return whether a file is there with this size and sum; false, and why, if not. */
static inline bool identity_holds(const char *folder, const char *name, unsigned long size, unsigned long sum,
                                  const char **why) {
    unsigned char bytes[4096];
    unsigned long found = 0, length = 0;
    size_t count;
    FILE *file = identity_open(folder, name, why);
    if (!*why) *why = file ? "was changed after the FMU was built" : "is missing";
    if (!file) return false;
    while ((count = fread(bytes, 1, sizeof bytes, file)) > 0) {
        found = identity_sum(found, bytes, count);
        length += (unsigned long)count;
    }
    const bool whole = !ferror(file);
    fclose(file);
    return whole && length == size && found == sum;
}

/* Check a row of identity.csv; false, with one message, if it differs from the tokens or from its file. */
static inline bool identity_agrees(char *row, const char *folder, const char *token, const char *binary,
                                   char problem[RESOURCES_PROBLEM]) {
    const char *name = row;
    char *value = strchr(row, ',');
    row[strcspn(row, "\r\n")] = '\0';
    if (!value) return !*row; /* an empty row at the end */
    *value++ = '\0';
    if (strcmp(name, "token") == 0 || strcmp(name, "binary") == 0) {
        if (strcmp(value, *name == 't' ? token : binary) == 0) return true;
        snprintf(problem, RESOURCES_PROBLEM, "The identifier of %s is not that of the resources. Unpack the whole FMU again.",
                 *name == 't' ? "modelDescription.xml" : "the binary");
        return false;
    }
    const unsigned long size = strtoul(value, &value, 10), sum = *value == ',' ? strtoul(value + 1, NULL, 16) : 0;
    const char *why;
    if (identity_holds(folder, name, size, sum, &why)) return true;
    snprintf(problem, RESOURCES_PROBLEM, "resources/%.60s %s. Unpack the FMU again, or build it with the new file.", name, why);
    return false;
}

/* Return whether the resources in a folder belong to a token and to the binary; false, with one message, if not. */
static inline bool identity_is(const char *folder, const char *token, const char *binary, char problem[RESOURCES_PROBLEM]) {
    char row[IDENTITY_ROW];
    int tokens = 0;
    bool good = true;
    const char *why;
    FILE *file = identity_open(folder, "identity.csv", &why);
    if (!file) {
        snprintf(problem, RESOURCES_PROBLEM,
                 "The identifier of modelDescription.xml is not that of the binary alone, and identity.csv of data %s in "
                 "%.90s. Give "
                 "the folder resources of the unpacked FMU, or build both together.",
                 why ? why : "is missing", folder);
        return false;
    }
    while (good && fgets(row, sizeof row, file)) {
        tokens += strncmp(row, "token,", 6) == 0 || strncmp(row, "binary,", 7) == 0;
        good = identity_agrees(row, folder, token, binary, problem);
    }
    fclose(file);
    if (good && tokens != 2) snprintf(problem, RESOURCES_PROBLEM, "resources/identity.csv is damaged. Unpack the FMU again.");
    return good && tokens == 2;
}

#endif
