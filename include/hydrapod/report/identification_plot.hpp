#pragma once
/// Pictures of frequency responses and of identified modes, drawn by gnuplot; formats and errors as
/// for plot_bode (bode.hpp).

#include "hydrapod/identification/identify.hpp"
#include "hydrapod/report/bode.hpp"

namespace hydrapod::report {

/// Magnitude and phase of the direct responses (output k from input k; all inputs where their
/// numbers differ), with their 95 % band and, if `model` is given, its synthesis.
void plot_responses(const identification::FrequencyResponses& responses,
                    const identification::ModalModel* model, const PlotText& text,
                    const std::string& path);

/// Multiple coherence of every output, and the condition of the input matrix.
void plot_coherence(const identification::FrequencyResponses& responses, const PlotText& text,
                    const std::string& path);

/// Poles over frequency and model order, those of modes marked, in front of the mode indicator.
void plot_stabilisation(const identification::Identification& result, const PlotText& text,
                        const std::string& path);

/// MAC of the modes with each other.
void plot_mac(const identification::Identification& result, const PlotText& text,
              const std::string& path);

/// Throws base::InputError for an ending that is no picture: before the work is done.
void require_picture(const std::string& path);

}  // namespace hydrapod::report
