"""What tests share: records, fits, servers, files, words."""
