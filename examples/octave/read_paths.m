% Reads paths.mat (output.mat), and draws a link's power delay profile and its power over time.
% octave read_paths.m paths.mat [PICTURE.png]
arguments_ = argv(); p = load(arguments_{1}); tx = 1; rx = 1;
shown = @(name) permute(p.(name)(:, rx, tx, :), [1 4 2 3]);       % [frame, path]
valid = shown('valid'); gain_db = 20 * log10(abs(shown('a')));    % shorter lists are padded with valid = false
printf('%d frames, %d paths, the strongest has %.15g dB\n', size(valid, 1), sum(valid(:)), max(gain_db(valid)));
if isempty(available_graphics_toolkits()), return; end
time_s = repmat(p.time_s(:), 1, size(valid, 2)); delay_ns = 1e9 * shown('tau');
figure('visible', 'off'); subplot(2, 1, 1); title([p.tx_id{tx} ' to ' p.rx_id{rx}]);
scatter(time_s(valid), delay_ns(valid), 20, gain_db(valid)); ylabel('delay (ns)');
subplot(2, 1, 2); plot(p.time_s, 10 * log10(sum(abs(shown('a')) .^ 2, 2))); xlabel('time (s)'); ylabel('path gain (dB)');
if numel(arguments_) > 1, print(arguments_{2}, '-dpng'); end
