"""The study of Osada, Shimizu & Wakai (2004), figure by figure: one short file per figure of the paper."""
