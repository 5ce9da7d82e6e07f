#!/usr/bin/env Rscript
# What R says of the tables that make_statistics.py wrote: NAME.r.csv beside each (response,quantity,value).
#
#     apt-get install r-base-core r-cran-car r-cran-rstatix
#     Rscript tests/reference/make_statistics.R
suppressMessages({library(car); library(rstatix)})
script <- sub("--file=", "", grep("--file=", commandArgs(FALSE), value = TRUE))
folder <- file.path(dirname(normalizePath(script)), "statistics")
options(contrasts = c("contr.sum", "contr.poly"))

anova_terms <- function(emit, kind, model, by) {
  table <- if (by == 1) anova(model) else Anova(model, type = 2)
  residual_df <- table["Residuals", "Df"]
  residual_ss <- table["Residuals", "Sum Sq"]
  total <- sum((model$model[[1]] - mean(model$model[[1]]))^2)
  for (term in rownames(table)) {
    prefix <- paste0(kind, ".", if (term == "Residuals") "residual" else term)
    ss <- table[term, "Sum Sq"]
    df <- table[term, "Df"]
    emit(paste0(prefix, ".df"), df)
    emit(paste0(prefix, ".ss"), ss)
    if (term == "Residuals") next
    f <- table[term, "F value"]
    emit(paste0(prefix, ".f"), f)
    emit(paste0(prefix, ".p"), pf(f, df, residual_df, lower.tail = FALSE))
    emit(paste0(prefix, ".log_p"), pf(f, df, residual_df, lower.tail = FALSE, log.p = TRUE))
    emit(paste0(prefix, ".eta2"), ss / total)
    emit(paste0(prefix, ".partial_eta2"), ss / (ss + residual_ss))
    emit(paste0(prefix, ".omega2"), (ss - df * residual_ss / residual_df) / (total + residual_ss / residual_df))
  }
}

analyse <- function(data, response, factors, emit) {
  data$value <- data[[response]]
  sizes <- table(data[factors])
  balanced <- length(unique(as.vector(sizes))) == 1
  main <- lm(reformulate(factors, "value"), data)
  anova_terms(emit, "main", main, 2)
  if (balanced) anova_terms(emit, "main.type1", main, 1)
  if (length(factors) > 1) {
    pairs <- lm(as.formula(paste("value ~ (", paste(factors, collapse = "+"), ")^2")), data)
    anova_terms(emit, "pairs", pairs, 2)
    if (balanced) anova_terms(emit, "pairs.type1", pairs, 1)
  }
  shapiro <- shapiro.test(residuals(main))
  emit("residuals.shapiro.w", shapiro$statistic)
  emit("residuals.shapiro.p", shapiro$p.value)
  for (level in levels(data[[factors[1]]])) {
    group <- data$value[data[[factors[1]]] == level]
    shapiro <- shapiro.test(group)
    emit(paste0(factors[1], ".", level, ".shapiro.w"), shapiro$statistic)
    emit(paste0(factors[1], ".", level, ".shapiro.p"), shapiro$p.value)
  }
  for (factor in factors) {
    groups <- data[[factor]]
    levene <- leveneTest(data$value, groups, center = median)
    emit(paste0(factor, ".brown_forsythe"), levene[1, "F value"])
    emit(paste0(factor, ".brown_forsythe.p"), levene[1, "Pr(>F)"])
    bartlett <- bartlett.test(data$value, groups)
    emit(paste0(factor, ".bartlett"), bartlett$statistic)
    emit(paste0(factor, ".bartlett.p"), bartlett$p.value)
    emit(paste0(factor, ".bartlett.log_p"),
         pchisq(bartlett$statistic, bartlett$parameter, lower.tail = FALSE, log.p = TRUE))
    kruskal <- kruskal.test(data$value, groups)
    emit(paste0(factor, ".h"), kruskal$statistic)
    emit(paste0(factor, ".h.p"), kruskal$p.value)
    emit(paste0(factor, ".h.log_p"),
         pchisq(kruskal$statistic, kruskal$parameter, lower.tail = FALSE, log.p = TRUE))
    emit(paste0(factor, ".epsilon2"), kruskal$statistic / (nrow(data) - 1))
    pairs <- as.data.frame(dunn_test(data.frame(value = data$value, groups = groups), value ~ groups,
                                     p.adjust.method = "holm"))
    for (i in seq_len(nrow(pairs))) {
      pair <- paste0(factor, ".", pairs$group1[i], "|", pairs$group2[i])
      emit(paste0(pair, ".z"), -pairs$statistic[i])  # rstatix subtracts the first from the second
      emit(paste0(pair, ".p"), pairs$p[i])
      emit(paste0(pair, ".log_p"), log(2) + pnorm(abs(pairs$statistic[i]), lower.tail = FALSE, log.p = TRUE))
      emit(paste0(pair, ".holm"), pairs$p.adj[i])
    }
  }
}

sets <- list(balanced = "y", unbalanced = "y", ties = "y", tiny = "y", machine = c("M", "L"))
for (name in names(sets)) {
  text <- read.csv(file.path(folder, paste0(name, ".csv")), colClasses = "character")
  factors <- setdiff(names(text), sets[[name]])
  data <- text
  for (factor in factors) data[[factor]] <- factor(text[[factor]], levels = unique(text[[factor]]))
  for (response in sets[[name]]) data[[response]] <- as.numeric(text[[response]])
  lines <- character()
  for (response in sets[[name]]) {
    emit <- function(key, value)
      lines[[length(lines) + 1]] <<- sprintf("%s,%s,%.17g", response, key, as.numeric(value))
    analyse(data, response, factors, emit)
  }
  writeLines(lines, file.path(folder, paste0(name, ".r.csv")))
}
